// SPDX-License-Identifier: MIT
// What a verb found out: keys and values in the order they were set, printed as one JSON object or as lines to read.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <lodestone/result.h>
#include <lodestone/types.h>

namespace lodestone::cli {

class Report {
 public:
  Report();
  ~Report();
  Report(const Report&) = delete;
  Report& operator=(const Report&) = delete;

  void set(const std::string& key, bool value);
  void set(const std::string& key, std::uint32_t value);
  void set(const std::string& key, std::uint64_t value);
  void set(const std::string& key, double value);  // null if not finite
  void set(const std::string& key, const std::string& value);
  void set(const std::string& key, const char* value) { set(key, std::string{value}); }
  void set(const std::string& key, const glm::dvec3& value);  // [x, y, z]
  void set(const std::string& key, const Box& value);         // [[x, y, z], [x, y, z]], null if empty
  void set(const std::string& key, const std::vector<double>& values);
  void set(const std::string& key, const std::vector<std::uint32_t>& values);
  void set(const std::string& key, const Report& object);
  void add(const std::string& key, const Report& object);  // to the end of the list `key`
  void set_null(const std::string& key);
  // Lines for people, printed below the keys; they do not see keys that hold objects or lists of objects.
  void show(const std::string& lines) { shown_ += lines; }

  void set_warnings(const std::vector<Warning>& warnings);
  void set_error(const Error& error);

  [[nodiscard]] std::string to_json() const;   // one line
  [[nodiscard]] std::string to_lines() const;  // "key  value", one a line, without the keys for machines

 private:
  struct Content;
  std::unique_ptr<Content> content_;
  std::string shown_;
};

}  // namespace lodestone::cli
