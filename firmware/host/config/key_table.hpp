// The keys that a program knows: name, unit, range and meaning of each, bound to the field that it sets.
//
// One table serves reading, checking, error messages and the printed list; its defaults are the values that
// the fields hold when the key is added.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "firmware/host/config/settings.hpp"

namespace fovea::config {

struct Key {
  std::string name;  // dotted
  std::string kind;  // "number", "whole number", "true or false", "text", "list of numbers", ...
  std::string unit;  // "" when it has none
  std::string allowed;
  std::string meaning;
  std::string default_text;
  std::function<void(const Setting&)> set;  // throws InputError
};

// The bound fields must outlive the table.
class KeyTable {
 public:
  void Number(std::string name, double& field, double min, double max, std::string unit, std::string meaning);
  void Integer(std::string name, int& field, int min, int max, std::string unit, std::string meaning);
  void Flag(std::string name, bool& field, std::string meaning);
  void Text(std::string name, std::string& field, std::string meaning);
  void Choice(std::string name, std::string& field, std::vector<std::string> choices, std::string meaning);
  // A list of `size_min` to `size_max` numbers.
  void Numbers(std::string name, std::vector<double>& field, std::size_t size_min, std::size_t size_max,
               double min, double max, std::string unit, std::string meaning);

  // Sets one field, or throws InputError and leaves it: unknown key (with the nearest known one), wrong
  // kind, out of range.
  void Apply(const Setting& setting) const;

  [[nodiscard]] const std::vector<Key>& keys() const { return keys_; }
  // What each key's field held when the key was added, by the key's name.
  [[nodiscard]] std::map<std::string, std::string> Values() const;

 private:
  void Add(Key key);

  std::vector<Key> keys_;
};

// The entry of `names` that is fewest edits away from `name`; "" when none is near. For "did you mean".
std::string Nearest(const std::string& name, const std::vector<std::string>& names);

}  // namespace fovea::config
