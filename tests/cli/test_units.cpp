// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>

#include "frame/units.h"

using namespace lodestone::cli;

TEST_CASE("lengths take a unit and default to metres") {
  CHECK(*parse_length_m("2mm") == Approx(0.002));
  CHECK(*parse_length_m("3cm") == Approx(0.03));
  CHECK(*parse_length_m("0.5m") == 0.5);
  CHECK(*parse_length_m("1km") == 1000.0);
  CHECK(*parse_length_m("7.25") == 7.25);
  CHECK(*parse_length_m("1e-3") == 0.001);
}

TEST_CASE("what is no length is refused with the word in the message") {
  for (const char* word : {"", "m", "1 m", "5ft", "nan", "inf", "1e999", "0x10", "2mmm"}) {
    INFO(word);
    const auto parsed = parse_length_m(word);
    REQUIRE_FALSE(parsed.ok());
    CHECK(parsed.error().code == lodestone::ErrorCode::BadArgument);
    CHECK(parsed.error().message.find("'" + std::string{word} + "'") == 0);
  }
}

TEST_CASE("byte sizes know powers of 1000 and of 1024") {
  CHECK(*parse_bytes("4096") == 4096);
  CHECK(*parse_bytes("512MB") == 512'000'000);
  CHECK(*parse_bytes("2GiB") == 2ULL << 30);
  CHECK(*parse_bytes("1.5KB") == 1500);
  for (const char* word : {"20KB", "20kB", "20kb", "20Kb"}) CHECK(*parse_bytes(word) == 20'000);
  CHECK(*parse_bytes("1mb") == 1'000'000);
  CHECK(*parse_bytes("1mib") == 1U << 20U);
  CHECK(parse_bytes("3XB").error().message.find("'3XB'") == 0);
  CHECK_FALSE(parse_bytes("-1").ok());
  CHECK_FALSE(parse_bytes("0.5").ok());
  CHECK_FALSE(parse_bytes("1e30").ok());
}

TEST_CASE("counts are whole and may be short") {
  CHECK(*parse_count("50000") == 50'000);
  CHECK(*parse_count("50k") == 50'000);
  CHECK(*parse_count("2M") == 2'000'000);
  CHECK_FALSE(parse_count("1.5").ok());
  CHECK_FALSE(parse_count("-3").ok());
}

TEST_CASE("points have exactly three lengths") {
  CHECK(*parse_point_m("1,-2.5,3km") == glm::dvec3{1.0, -2.5, 3000.0});
  for (const char* word : {"1,2", "1,2,3,4", "1,,3", "a,b,c", ""}) CHECK_FALSE(parse_point_m(word).ok());
}

TEST_CASE("picture sizes are bounded") {
  const auto size = parse_picture_size("640x480");
  REQUIRE(size.ok());
  CHECK(size->width_px == 640);
  CHECK(size->height_px == 480);
  for (const char* word : {"640", "0x480", "640x", "99999x10", "x"}) CHECK_FALSE(parse_picture_size(word).ok());
}
