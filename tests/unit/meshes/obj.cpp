// SPDX-License-Identifier: MIT
#include "data.h"
#include "reading.h"

using namespace lodestone;
using lodestone::test::corner;
using lodestone::test::read_text;
using lodestone::test::warned;

namespace {

constexpr std::string_view square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

std::string with_square(std::string_view rest) { return std::string{square} + std::string{rest}; }

}  // namespace

TEST_CASE("obj: wedges are shared where position, uv and normal agree") {
  const auto read = read_text(with_square("vt 0 0\nvt 1 1\nvn 0 0 1\n"
                                          "f 1/1/1 2/1/1 3/1/1\nf 1/1/1 3/1/1 4/1/1\nf 1/2/1 3/1/1 4/1/1\n"),
                              "a.obj");
  REQUIRE(read.ok());
  CHECK(read->mesh.triangle_count() == 3);
  CHECK(read->mesh.vertex_count() == 5);
  CHECK(read->mesh.indices == std::vector<VertexId>{0, 1, 2, 0, 2, 3, 4, 2, 3});
  CHECK(read->mesh.vertices.uvs[4] == glm::vec2(1.0F, 1.0F));
  CHECK(read.warnings().empty());
}

TEST_CASE("obj: negative indices count back from the last") {
  const auto read = read_text(with_square("f -4 -3 -2\nv 5 5 5\nf -5 -3 -2\n"), "a.obj");
  REQUIRE(read.ok());
  REQUIRE(read->mesh.triangle_count() == 2);
  CHECK(corner(read->mesh, 0, 0) == glm::dvec3(0, 0, 0));
  CHECK(corner(read->mesh, 1, 0) == glm::dvec3(0, 0, 0));
  CHECK(corner(read->mesh, 1, 1) == glm::dvec3(1, 1, 0));
}

TEST_CASE("obj: faces that name no vertex, have two corners or a corner that is no number are left out") {
  const auto read = read_text(with_square("v nan 0 0\nv 1 x 0\n"
                                          "f 1 2 3\nf 1 2 99\nf 0 1 2\nf -9 1 2\nf 1 2\nf a b c\nf 1 2 5\nf 1 2 6\n"
                                          "f 99999999999999999999 1 2\nf 4294967297 1 2\n"),
                              "a.obj");
  REQUIRE(read.ok());
  CHECK(read->mesh.triangle_count() == 1);
  CHECK(warned(read, "names a vertex that does not exist"));
  CHECK(warned(read, "fewer than three corners"));
  CHECK(warned(read, "not a finite number"));
  const auto missing = std::find_if(read.warnings().begin(), read.warnings().end(), [](const Warning& w) {
    return w.message.find("does not exist") != std::string::npos;
  });
  CHECK(missing->count == 6);
  CHECK(missing->where == "a.obj, line 8");
}

TEST_CASE("obj: a uv or normal that does not exist or is no number leaves its face in place") {
  const auto read = read_text(with_square("vt nan 0.5\nvn 0 0 nan\nf 1/7 2/1 3/1\nf 1//1 3//1 4//9\n"), "a.obj");
  REQUIRE(read.ok());
  CHECK(read->mesh.triangle_count() == 2);
  CHECK(warned(read, "names a texture coordinate that does not exist"));
  CHECK(warned(read, "names a normal that does not exist"));
  for (const auto& n : read->mesh.vertices.normals) CHECK(n == glm::vec3(0, 0, 1));
}

TEST_CASE("obj: degenerate and duplicate faces are source faces and stay") {
  const auto read = read_text(with_square("f 1 1 2\nf 1 2 3\nf 1 2 3\nf 3 2 1\n"), "a.obj");
  REQUIRE(read.ok());
  CHECK(read->mesh.triangle_count() == 4);
}

TEST_CASE("obj: polygons keep their area, concave ones too") {
  const auto quad = read_text(with_square("f 1 2 3 4\n"), "a.obj");
  CHECK(quad->mesh.triangle_count() == 2);
  CHECK(test::area(quad->mesh) == Approx(1.0));
  // A dart whose reflex corner is the third: a fan from the first works, one from the second does not.
  const auto dart = read_text("v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nf 2 3 4 1\n", "a.obj");
  CHECK(test::area(dart->mesh) == Approx(4.0));
  // A comb: no corner sees all others.
  const auto comb = read_text(
      "v 0 0 0\nv 7 0 0\nv 7 3 0\nv 6 3 0\nv 6 1 0\nv 4 1 0\nv 4 3 0\nv 3 3 0\nv 3 1 0\nv 1 1 0\nv 1 3 0\nv 0 3 0\n"
      "f 1 2 3 4 5 6 7 8 9 10 11 12\n",
      "a.obj");
  CHECK(comb->mesh.triangle_count() == 10);
  CHECK(test::area(comb->mesh) == Approx(7.0 + 3 * 2.0));
}

TEST_CASE("obj: groups become features, objects their parents") {
  const auto read =
      read_text(with_square("f 1 2 3\no house\ng wall\nf 1 2 3\ng roof\nf 1 3 4\ng wall\nf 2 3 4\n"), "a.obj");
  REQUIRE(read.ok());
  const Mesh& mesh = read->mesh;
  REQUIRE(mesh.features.size() == 3);
  CHECK(mesh.features[0].id == "house");
  CHECK(mesh.features[1].id == "house/wall");
  CHECK(mesh.features[1].parent == 0);
  CHECK(mesh.face_features == std::vector<FeatureId>{none, 1, 2, 1});
}

TEST_CASE("obj: colours after the position are read, in shares of one or in bytes") {
  const auto shares = read_text("v 0 0 0 1 0 0.5\nv 1 0 0 0 1 0\nv 0 1 0\nf 1 2 3\n", "a.obj");
  REQUIRE(shares.ok());
  CHECK(shares->mesh.vertices.colors[0] == glm::u8vec4(255, 0, 128, 255));
  CHECK(shares->mesh.vertices.colors[2] == glm::u8vec4(255, 255, 255, 255));
  const auto bytes = read_text("v 0 0 0 200 10 0\nv 1 0 0 0 1 0\nv 0 1 0 9 9 9\nf 1 2 3\n", "a.obj");
  CHECK(bytes->mesh.vertices.colors[0] == glm::u8vec4(200, 10, 0, 255));
}

TEST_CASE("obj: continued lines, tabs, comments, Windows and old Mac line ends, no last line end") {
  for (const char* end : {"\n", "\r\n", "\r"}) {
    std::string text = "# head\n\nv\t0 0 0\nv +1 0 0\n  v 1.0e0 1 0 # corner\ns off\nf 1 \\\n 2 \\\n3";
    std::string with_end;
    for (const char c : text) c == '\n' ? with_end.append(end) : with_end.append(1, c);
    const auto read = read_text(with_end, "a.obj");
    CAPTURE(end);
    REQUIRE(read.ok());
    CHECK(read->mesh.triangle_count() == 1);
    CHECK(read.warnings().empty());
  }
}

TEST_CASE("obj: materials come from the library, whatever options, case and slashes its lines use") {
  const auto folder = test::scratch_folder("obj_materials");
  std::filesystem::create_directories(folder / "Textures");
  REQUIRE(write_image(Image{2, 1, 3, {1, 2, 3, 4, 5, 6}}, folder / "Textures" / "Stone Wall.PNG").ok());
  test::write_text(folder / "House.MTL",
                   "newmtl stone\nKd 0.5 0.25 1\nmap_Kd -bm 0.3 -s 1 1 1 -o 0 0 0 textures\\stone wall.png\n"
                   "newmtl glass\nKd 0 0 1\nTr 0.75\nd 0.5\nTr 0.9\nnewmtl thin\nTr 0.75\n"
                   "newmtl lost\nmap_Kd nowhere.jpg\nnewmtl stone\nKd 1 0 0\n");
  const std::string text = with_square(
      "mtllib house.mtl missing.mtl\nf 1 2 3\nusemtl stone\nf 1 2 3\nusemtl glass\nf 1 2 3\n"
      "usemtl lost\nf 1 2 3\nusemtl thin\nf 1 2 3\nusemtl unknown\nf 1 2 3\n");
  for (const LoadTextures textures : {LoadTextures::Reference, LoadTextures::Encoded, LoadTextures::Decoded}) {
    ReadOptions options;
    options.textures = textures;
    const auto read = read_text(text, (folder / "a.obj").string(), options, folder);
    REQUIRE(read.ok());
    const Mesh& mesh = read->mesh;
    REQUIRE(mesh.materials.size() == 6);
    CHECK(mesh.face_materials == std::vector<MaterialId>{0, 1, 2, 3, 4, 5});
    CHECK(mesh.materials[1].base_color == glm::vec4(0.5F, 0.25F, 1.0F, 1.0F));
    CHECK(mesh.materials[2].base_color.a == 0.5F);
    CHECK(mesh.materials[4].base_color.a == 0.25F);
    CHECK(mesh.materials[3].texture == none);
    CHECK(mesh.materials[3].base_color == glm::vec4(1.0F));
    REQUIRE(mesh.textures.size() == 1);
    CHECK(mesh.materials[1].texture == 0);
    CHECK(std::filesystem::exists(mesh.textures[0].path));
    CHECK((mesh.textures[0].encoded != nullptr) == (textures != LoadTextures::Reference));
    CHECK((mesh.textures[0].image != nullptr) == (textures == LoadTextures::Decoded));
    CHECK(warned(read, "\"missing.mtl\" cannot be read"));
    CHECK(warned(read, "\"nowhere.jpg\" is missing"));
    CHECK(warned(read, "\"unknown\" is not defined"));
    CHECK(warned(read, "defined twice"));
  }
}

TEST_CASE("obj: textures are found by names in quotes, with comments, as addresses and from other machines") {
  const auto folder = test::scratch_folder("obj_texture_names");
  const Image image{2, 1, 3, {1, 2, 3, 4, 5, 6}};
  std::filesystem::create_directories(folder / "tex");
  for (const char* name : {"tex/p 0.png", "tex/a #1.png", "beside.png"}) {
    REQUIRE(write_image(image, folder / name).ok());
  }
  const std::string place = std::filesystem::absolute(folder).string();
  const std::pair<std::string, const char*> cases[] = {{"tex/p 0.png # photograph", "tex/p 0.png"},
                                                       {"tex/p 0.png\t#photograph", "tex/p 0.png"},
                                                       {"tex/a #1.png", "tex/a #1.png"},
                                                       {"tex/a #1.png # first", "tex/a #1.png"},
                                                       {"\"tex/p 0.png\"", "tex/p 0.png"},
                                                       {"-clamp on \"tex/p 0.png\" # quoted", "tex/p 0.png"},
                                                       {"file://" + place + "/tex/p%200.png", "tex/p 0.png"},
                                                       {"file://localhost" + place + "/tex/p 0.png", "tex/p 0.png"},
                                                       {"file:///C:/lost/beside.png", "beside.png"},
                                                       {"C:\\photos\\tex\\p 0.png", "tex/p 0.png"},
                                                       {"/no/such/place/beside.png", "beside.png"}};
  for (const auto& [written, file] : cases) {
    CAPTURE(written);
    test::write_text(folder / "my stone.mtl", "newmtl m\nmap_Kd " + written + "\n");
    for (const char* library : {"my stone.mtl", "\"my stone.mtl\""}) {
      const std::string text = with_square(std::string{"mtllib "} + library + "\nusemtl m\nf 1 2 3\n");
      const auto read = read_text(text, (folder / "a.obj").string(), {}, folder);
      REQUIRE(read.ok());
      CHECK(read.warnings().empty());
      REQUIRE(read->mesh.textures.size() == 1);
      CHECK(std::filesystem::equivalent(read->mesh.textures[0].path, folder / file));
    }
  }
}

TEST_CASE("obj: a library in a folder of its own names its textures from there, or from the model's folder") {
  const auto folder = test::scratch_folder("obj_library_folder");
  std::filesystem::create_directories(folder / "looks");
  for (const char* name : {"looks/near.png", "looks/both.png", "both.png", "far.png"}) {
    REQUIRE(write_image(Image{1, 1, 3, {1, 2, 3}}, folder / name).ok());
  }
  test::write_text(folder / "looks" / "a.mtl",
                   "newmtl a\nmap_Kd near.png\nnewmtl b\nmap_Kd both.png\nnewmtl c\nmap_Kd far.png\n");
  const auto read = read_text(with_square("mtllib looks/a.mtl # of the church\n"
                                          "usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\nusemtl c\nf 1 2 3\n"),
                              (folder / "a.obj").string(), {}, folder);
  REQUIRE(read.ok());
  CHECK(read.warnings().empty());
  REQUIRE(read->mesh.textures.size() == 3);
  const char* files[] = {"looks/near.png", "looks/both.png", "far.png"};
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(std::filesystem::equivalent(read->mesh.textures[i].path, folder / files[i]));
  }
}

TEST_CASE("obj: a byte order mark before the model and before its library costs neither its first line") {
  const auto folder = test::scratch_folder("obj_mark");
  test::write_text(folder / "a.mtl", "\xEF\xBB\xBFnewmtl m\nKd 0 0 1\n");
  const auto read = read_text("\xEF\xBB\xBFmtllib a.mtl\n" + with_square("usemtl m\nf 1 2 3\n"),
                              (folder / "a.obj").string(), {}, folder);
  REQUIRE(read.ok());
  CHECK(read.warnings().empty());
  CHECK(read->mesh.materials.front().base_color == glm::vec4(0, 0, 1, 1));
  const auto first = read_text("\xEF\xBB\xBF" + with_square("f 1 2 3\n"), "a.obj");
  REQUIRE(first.ok());
  CHECK(first->mesh.triangle_count() == 1);
  CHECK(read_text("\xEF\xBB\xBF", "a.obj").error().code == ErrorCode::BadData);
}

TEST_CASE("obj: what is said of a texture that is missing, or is a folder, names the line that asks for it") {
  const auto folder = test::scratch_folder("obj_texture_lost");
  std::filesystem::create_directories(folder / "tex" / "dir.jpg");
  test::write_text(folder / "a.mtl",
                   "newmtl m\nmap_Kd lost.jpg # photograph\nnewmtl n\nKd 1 1 1\nmap_Kd tex/dir.jpg\n");
  const auto read = read_text(with_square("mtllib a.mtl\nusemtl m\nf 1 2 3\nusemtl n\nf 1 3 4\n"),
                              (folder / "a.obj").string(), {}, folder);
  REQUIRE(read.ok());
  REQUIRE(read.warnings().size() == 2);
  const std::string library = (folder / "a.mtl").string();
  CHECK(read.warnings()[0].message == "the texture \"lost.jpg # photograph\" is missing");
  CHECK(read.warnings()[0].where == library + ", line 2");
  CHECK(read.warnings()[1].message == "the texture \"tex/dir.jpg\" is a folder");
  CHECK(read.warnings()[1].where == library + ", line 5");
}

TEST_CASE("obj: a texture's alpha makes holes where the library asks for it, a mask of its own is told of") {
  const auto folder = test::scratch_folder("obj_masks");
  REQUIRE(write_image(Image{1, 1, 4, {1, 2, 3, 0}}, folder / "leaf.png").ok());
  REQUIRE(write_image(Image{1, 1, 1, {0}}, folder / "mask.png").ok());
  test::write_text(folder / "a.mtl",
                   "newmtl plain\nmap_Kd leaf.png\nnewmtl holes\nmap_d leaf.png\nmap_Kd leaf.png\n"
                   "newmtl other\nmap_Kd leaf.png\nmap_d mask.png\n");
  const auto read = read_text(with_square("mtllib a.mtl\nusemtl plain\nf 1 2 3\nusemtl holes\nf 1 2 3\n"
                                          "usemtl other\nf 1 2 3\n"),
                              (folder / "a.obj").string(), {}, folder);
  REQUIRE(read.ok());
  CHECK(read->mesh.materials[0].alpha_cutoff == 0.0F);
  CHECK(read->mesh.materials[1].alpha_cutoff == 0.5F);
  REQUIRE(read.warnings().size() == 1);
  CHECK(warned(read, "a mask that is not the texture itself is not used"));
  CHECK(read.warnings().front().where == (folder / "a.mtl").string() + ", line 7");
}

TEST_CASE("obj: a texture that is no image is a warning") {
  const auto folder = test::scratch_folder("obj_bad_texture");
  test::write_text(folder / "a.mtl", "newmtl m\nmap_Kd a.jpg\nnewmtl n\nmap_Kd b.jpg\n");
  test::write_text(folder / "a.jpg", "this is no picture");
  test::write_text(folder / "b.jpg", "\xFF\xD8\xFF\xE0 cut off");
  ReadOptions options;
  options.textures = LoadTextures::Decoded;
  const auto read =
      read_text(with_square("mtllib a.mtl\nusemtl m\nf 1 2 3\nusemtl n\nf 1 2 4\n"), "a.obj", options, folder);
  REQUIRE(read.ok());
  CHECK(read->mesh.textures.empty());
  CHECK(warned(read, "is not an image"));
  CHECK(warned(read, "a texture cannot be used"));
}

TEST_CASE("obj: coordinates of a national grid keep 0.1 mm, wherever the first vertex lies") {
  const std::string far =
      "v 678116.1234 5403773.5678 416.4321\nv 678117.1234 5403773.5678 416.4321\nv 678116.1234 5403774.5679 416.4321\n";
  const std::string outlier = "v 0 0 0\n" + far;
  const auto read = read_text(far + "f 1 2 3\n", "a.obj");
  REQUIRE(read.ok());
  CHECK(read->mesh.origin.z == 0.0);
  CHECK(glm::length(corner(read->mesh, 0, 2) - glm::dvec3(678116.1234, 5403774.5679, 416.4321)) < 5e-5);
  const auto skewed = read_text(outlier + "f 2 3 4\n", "a.obj");
  REQUIRE(skewed.ok());
  CHECK(skewed->mesh.vertex_count() == 3);
  // The vertex at zero is of no face, so it costs nothing.
  CHECK(glm::length(corner(skewed->mesh, 0, 2) - glm::dvec3(678116.1234, 5403774.5679, 416.4321)) < 5e-5);
  const auto spread = read_text(outlier + "f 1 3 4\n", "a.obj");
  REQUIRE(spread.ok());
  // A face that reaches so far costs precision: half of 5,400 km in floats; no more than that.
  CHECK(glm::length(corner(spread->mesh, 0, 2) - glm::dvec3(678116.1234, 5403774.5679, 416.4321)) < 0.3);
}

TEST_CASE("obj: the header tells offset, reference system and axes") {
  const auto read = read_text(
      "# offset subtracted: 678116 5403773 416 ; Z up, metres\n# crs EPSG:25832\n" + with_square("f 1 2 3\n"), "a.obj");
  REQUIRE(read.ok());
  CHECK(read->mesh.origin == glm::dvec3(678116, 5403773, 416));
  CHECK(read->mesh.crs == "EPSG:25832");
  CHECK(read->info.up_axis == "Z");
  const auto y_up = read_text("# Y-up\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 1 0\nf 1//1 2//1 3//1\n", "a.obj");
  CHECK(y_up->info.up_axis == "Y");
  CHECK(corner(y_up->mesh, 0, 2) == glm::dvec3(0, 0, 1));
  CHECK(y_up->mesh.vertices.normals[0] == glm::vec3(0, 0, 1));
  ReadOptions options;
  options.up = UpAxis::Y;
  options.unit_m = 0.01;
  const auto told = read_text(with_square("f 1 2 3\n"), "a.obj", options);
  CHECK(corner(told->mesh, 0, 2).z == Approx(0.01));
  CHECK(told->info.unit_m == 0.01);
}

TEST_CASE("obj: caps refuse instead of filling the memory") {
  ReadOptions options;
  options.max_vertices = 3;
  CHECK(read_text(with_square("f 1 2 3\n"), "a.obj", options).error().code == ErrorCode::TooLarge);
  options.max_vertices = 4;
  options.max_triangles = 1;
  CHECK(read_text(with_square("f 1 2 3 4\n"), "a.obj", options).error().code == ErrorCode::TooLarge);
  options.max_triangles = 2;
  CHECK(read_text(with_square("f 1 2 3 4\n"), "a.obj", options).ok());
}

TEST_CASE("obj: one corner used with a hundred thousand uvs does not take for ever") {
  std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (int i = 0; i < 100'000; ++i) text += "vt 0." + std::to_string(i) + " 0\n";
  for (int i = 1; i <= 100'000; ++i) text += "f 1/" + std::to_string(i) + " 2 3\n";
  const auto read = read_text(text, "a.obj");
  REQUIRE(read.ok());
  CHECK(read->mesh.triangle_count() == 100'000);
}

TEST_CASE("obj: what is no mesh at all is refused with its name") {
  CHECK(read_text("", "a.obj").error().code == ErrorCode::BadData);
  CHECK(read_text("hello\nworld\n", "a.obj").error().where == "a.obj");
  CHECK(read_text("hello\nworld\n", "a.xyzzy").error().code == ErrorCode::Unsupported);
  CHECK(read_mesh("/no/such/file.obj").error().code == ErrorCode::NotFound);
  CHECK(read_mesh("/").error().code == ErrorCode::Unreadable);
}

TEST_CASE("obj: is known by its content under any name") {
  CHECK(read_text(with_square("f 1 2 3\n"), "mesh.txt")->info.format == "obj");
}

TEST_CASE("obj: reading can be cancelled") {
  const std::atomic<bool> stop{true};
  Context context;
  context.cancel = &stop;
  const std::string text = with_square("f 1 2 3\n");
  const std::span bytes{reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
  const auto read = read_obj(Input::from_bytes(bytes, "a.obj"), {}, context);
  REQUIRE_FALSE(read.ok());
  CHECK(read.error().code == ErrorCode::Cancelled);
}
