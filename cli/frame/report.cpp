// SPDX-License-Identifier: MIT
// The only file of the program that names the JSON library.
#include "report.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace lodestone::cli {
namespace {

using Json = nlohmann::ordered_json;

Json finite_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json to_array(const glm::dvec3& v) {
  return Json::array({finite_or_null(v.x), finite_or_null(v.y), finite_or_null(v.z)});
}

const char* name(ErrorCode code) {
  switch (code) {
    case ErrorCode::NotFound:
      return "not_found";
    case ErrorCode::Unreadable:
      return "unreadable";
    case ErrorCode::BadData:
      return "bad_data";
    case ErrorCode::Unsupported:
      return "unsupported";
    case ErrorCode::TooLarge:
      return "too_large";
    case ErrorCode::BadArgument:
      return "bad_argument";
    case ErrorCode::Cancelled:
      return "cancelled";
  }
  return "unknown";
}

// File names may hold any bytes; what is not UTF-8 is replaced rather than refused.
std::string dump(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

// What only a program wants; people get warnings and errors on stderr.
bool for_machines(const std::string& key, const Json& value) {
  return key == "warnings" || key == "error" || key == "lodestone" || value.is_object() ||
         (value.is_array() && !value.empty() && value.front().is_object());
}

}  // namespace

struct Report::Content {
  Json json = Json::object();
};

Report::Report() : content_(std::make_unique<Content>()) {}
Report::~Report() = default;

void Report::set(const std::string& key, bool value) { content_->json[key] = value; }
void Report::set(const std::string& key, std::uint32_t value) { content_->json[key] = value; }
void Report::set(const std::string& key, std::uint64_t value) { content_->json[key] = value; }
void Report::set(const std::string& key, double value) { content_->json[key] = finite_or_null(value); }
void Report::set(const std::string& key, const std::string& value) { content_->json[key] = value; }
void Report::set(const std::string& key, const glm::dvec3& value) { content_->json[key] = to_array(value); }
void Report::set(const std::string& key, const std::vector<std::uint32_t>& values) { content_->json[key] = values; }
void Report::set(const std::string& key, const Report& object) { content_->json[key] = object.content_->json; }
void Report::add(const std::string& key, const Report& object) { content_->json[key].push_back(object.content_->json); }

void Report::set(const std::string& key, const std::vector<double>& values) {
  Json list = Json::array();
  for (const double value : values) list.push_back(finite_or_null(value));
  content_->json[key] = std::move(list);
}

void Report::set_null(const std::string& key) { content_->json[key] = nullptr; }

void Report::set(const std::string& key, const Box& value) {
  if (value.empty()) return set_null(key);
  content_->json[key] = Json::array({to_array(value.min), to_array(value.max)});
}

void Report::set_warnings(const std::vector<Warning>& warnings) {
  Json lines = Json::array();
  for (const Warning& warning : warnings) lines.push_back(to_line(warning));
  content_->json["warnings"] = std::move(lines);
}

void Report::set_error(const Error& error) {
  content_->json["error"] = {{"code", name(error.code)}, {"message", error.message}, {"where", error.where}};
}

std::string Report::to_json() const { return dump(content_->json); }

std::string Report::to_lines() const {
  std::size_t width = 0;
  for (const auto& [key, value] : content_->json.items()) {
    if (!for_machines(key, value)) width = std::max(width, key.size());
  }
  std::string lines;
  for (const auto& [key, value] : content_->json.items()) {
    if (for_machines(key, value)) continue;
    lines += key + std::string(width - key.size() + 2, ' ');
    lines += value.is_string() ? value.get<std::string>() : dump(value);
    lines += '\n';
  }
  return lines + shown_;
}

}  // namespace lodestone::cli
