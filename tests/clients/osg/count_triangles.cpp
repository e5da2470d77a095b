// SPDX-License-Identifier: MIT
// What OpenSceneGraph draws of a tree of files, without a window: its own cull traversal, paging at once.
//
//     count_triangles main.osgb DISTANCE_IN_RADII...
//
// Prints one number of triangles per distance, skirts left out; ends with 1 if a file could not be read.
#include <osg/Geometry>
#include <osg/PagedLOD>
#include <osg/Viewport>
#include <osgDB/FileNameUtils>
#include <osgDB/ReadFile>
#include <osgUtil/CullVisitor>
#include <osgUtil/RenderStage>
#include <osgUtil/StateGraph>

#include <cstdio>
#include <cstdlib>

namespace {

// Reads what is asked for there and then.
class Reader final : public osg::NodeVisitor::DatabaseRequestHandler {
 public:
  void requestNodeFile(const std::string& name, osg::NodePath& path, float, const osg::FrameStamp*,
                       osg::ref_ptr<osg::Referenced>&, const osg::Referenced* options) override {
    auto* paged = dynamic_cast<osg::PagedLOD*>(path.back());
    const auto* read_options = dynamic_cast<const osgDB::Options*>(options);
    osg::ref_ptr<osg::Node> node = osgDB::readRefNodeFile(name, read_options);
    if (!node || paged == nullptr) {
      std::fprintf(stderr, "cannot be read: %s\n", name.c_str());
      ++failures;
      return;
    }
    if (paged->getNumChildren() < 2) paged->addChild(node);
    ++reads;
  }
  int reads = 0;
  int failures = 0;
};

class Counter final : public osgUtil::CullVisitor {
 public:
  using CullVisitor::apply;
  void apply(osg::Geode& geode) override {
    for (unsigned i = 0; i < geode.getNumDrawables(); ++i) count(geode.getDrawable(i));
  }
  void count(osg::Drawable* drawable) {
    const osg::Geometry* geometry = drawable->asGeometry();
    if (drawable->getName() == "lodestone:skirt") return;
    for (unsigned i = 0; geometry != nullptr && i < geometry->getNumPrimitiveSets(); ++i) {
      triangles += geometry->getPrimitiveSet(i)->getNumPrimitives();
    }
  }
  unsigned long triangles = 0;
};

unsigned long triangles_from(osg::Node& root, double radii, Reader& reader) {
  const osg::BoundingSphere sphere = root.getBound();
  osg::ref_ptr<osg::Viewport> viewport = new osg::Viewport(0, 0, 1920, 1080);
  osg::ref_ptr<osg::RefMatrix> projection = new osg::RefMatrix;
  projection->makePerspective(0.8 * 180.0 / 3.14159265358979, 1920.0 / 1080.0, 0.1, 1e6);
  osg::ref_ptr<osg::RefMatrix> view = new osg::RefMatrix;
  const osg::Vec3d center{sphere.center()};
  view->makeLookAt(center + osg::Vec3d(0.0, -radii * sphere.radius(), 0.0), center, osg::Vec3d(0.0, 0.0, 1.0));
  while (true) {
    osg::ref_ptr<Counter> counter = new Counter;
    osg::ref_ptr<osg::FrameStamp> stamp = new osg::FrameStamp;
    osg::ref_ptr<osgUtil::StateGraph> states = new osgUtil::StateGraph;
    osg::ref_ptr<osgUtil::RenderStage> stage = new osgUtil::RenderStage;
    counter->setFrameStamp(stamp);
    counter->setDatabaseRequestHandler(&reader);
    counter->setStateGraph(states);
    counter->setRenderStage(stage);
    counter->setCullingMode(osg::CullSettings::NO_CULLING);
    counter->pushViewport(viewport);
    counter->pushProjectionMatrix(projection);
    counter->pushModelViewMatrix(view, osg::Transform::ABSOLUTE_RF);
    const int before = reader.reads + reader.failures;
    root.accept(*counter);
    counter->popModelViewMatrix();
    counter->popProjectionMatrix();
    counter->popViewport();
    if (reader.reads + reader.failures == before || reader.failures > 0) return counter->triangles;
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return 1;
  osg::ref_ptr<Reader> reader = new Reader;
  for (int i = 2; i < argc; ++i) {
    osg::ref_ptr<osg::Node> root = osgDB::readRefNodeFile(argv[1]);
    if (!root) return 1;
    std::printf("%lu\n", triangles_from(*root, std::atof(argv[i]), *reader));
  }
  return reader->failures > 0 ? 1 : 0;
}
