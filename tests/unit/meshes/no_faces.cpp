// SPDX-License-Identifier: MIT
// A file without a surface is refused at the door of all readers: nothing that follows could make anything of it.
#include "reading.h"

using namespace lodestone;

TEST_CASE("what has no faces is refused with its name and what was left out, by every reader") {
  const struct {
    const char* name;
    std::string_view text;
  } files[] = {
      {"a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nl 1 2 3\n"},
      {"a.ply",
       "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 "
       "3\n"},
      {"a.gltf",
       R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[
          {"attributes":{"POSITION":0},"mode":0}]}],"buffers":[{"byteLength":12,
          "uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAA"}],"bufferViews":[{"buffer":0,"byteLength":12}],
          "accessors":[{"bufferView":0,"componentType":5126,"count":1,"type":"VEC3","min":[0,0,0],"max":[0,0,0]}]})"},
      {"a.json", R"({"type":"CityJSON","version":"2.0","CityObjects":{},"vertices":[[0,0,0]],
                     "transform":{"scale":[1,1,1],"translate":[0,0,0]}})"},
      {"a.gml", R"(<?xml version="1.0"?><core:CityModel xmlns:core="http://www.opengis.net/citygml/2.0"/>)"},
      {"a.stl",
       "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 nan\nvertex 1 0 nan\nvertex 0 1 nan\nendloop\n"
       "endfacet\nendsolid a\n"},
  };
  for (const auto& file : files) {
    INFO(file.name);
    const auto read = test::read_text(file.text, file.name);
    REQUIRE_FALSE(read.ok());
    INFO(read.error().message);
    CHECK(read.error().code == ErrorCode::BadData);
    CHECK(read.error().where == file.name);
    CHECK(read.error().message.find(" no ") != std::string::npos);
  }
  CHECK(test::read_text(files[0].text, "a.obj").error().message.find("lines and points are left out") !=
        std::string::npos);
}
