// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>
#include <limits>
#include <nlohmann/json.hpp>

#include "frame/report.h"

using lodestone::cli::Report;

TEST_CASE("a report is one JSON object on one line, keys in the order they were set") {
  Report report;
  report.set("zebra", 1U);
  report.set("apple", "a \"quoted\" word");
  report.set("point", glm::dvec3{1.0, 2.0, 3.0});
  const std::string text = report.to_json();
  CHECK(text == R"({"zebra":1,"apple":"a \"quoted\" word","point":[1.0,2.0,3.0]})");
}

TEST_CASE("numbers that JSON cannot hold become null") {
  Report report;
  report.set("infinite", std::numeric_limits<double>::infinity());
  report.set("nan", std::numeric_limits<double>::quiet_NaN());
  report.set("empty", lodestone::Box{});
  CHECK(report.to_json() == R"({"infinite":null,"nan":null,"empty":null})");
}

TEST_CASE("a file name that is not UTF-8 does not break the report") {
  Report report;
  report.set("file", std::string{"caf\xE9.obj"});
  CHECK(nlohmann::json::accept(report.to_json()));
}

TEST_CASE("warnings and errors are told") {
  Report report;
  report.set_warnings({{"texture is missing", "a.mtl:3", 2}});
  report.set_error({lodestone::ErrorCode::BadData, "cut short", "a.obj"});
  const auto json = nlohmann::json::parse(report.to_json());
  CHECK(json["warnings"].size() == 1);
  CHECK(json["warnings"][0] == "a.mtl:3: texture is missing (2 times)");
  CHECK(json["error"]["code"] == "bad_data");
  CHECK(report.to_lines().empty());
}
