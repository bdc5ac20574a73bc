// SPDX-License-Identifier: Apache-2.0
// The keys that a program knows: name, unit, range and meaning of each, bound to the field that it sets.
//
// One table serves reading, checking, error messages and the printed list. A key's default is the value of
// its field when the key is added.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <type_traits>
#include <vector>

#include "firmware/host/config/settings.hpp"

namespace fovea::config {

struct Key {
  std::string name;  // dotted
  std::string kind;  // "a number", "a whole number", "a flag", "a text", "one of", "a list of 3 numbers"
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
  // The same for a field that holds the value in another unit or form: `set` stores it.
  void Number(std::string name, double value, double min, double max, std::string unit, std::string meaning,
              std::function<void(double)> set);
  void Integer(std::string name, int value, int min, int max, std::string unit, std::string meaning,
               std::function<void(int)> set);
  void Flag(std::string name, bool& field, std::string meaning);
  void Text(std::string name, std::string& field, std::string meaning);
  void Choice(std::string name, std::string& field, std::vector<std::string> choices, std::string meaning);
  // An enumerator by its name: `names` in the order of the enumeration.
  template <class Enum, class Names>
  requires std::is_enum_v<Enum>
  void Choice(const std::string& name, Enum& field, const Names& names, const std::string& meaning) {
    AddChoice(name, static_cast<std::size_t>(field), {names.begin(), names.end()}, meaning,
              [&field](std::size_t chosen) { field = static_cast<Enum>(chosen); });
  }
  // A list of `size_min` to `size_max` numbers.
  void Numbers(std::string name, std::vector<double>& field, std::size_t size_min, std::size_t size_max,
               double min, double max, std::string unit, std::string meaning);
  void Numbers(std::string name, const std::vector<double>& values, std::size_t size_min,
               std::size_t size_max, double min, double max, std::string unit, std::string meaning,
               std::function<void(const std::vector<double>&)> set);
  // One number, or a list of 1 to `size_max`; the field is empty if nothing is set.
  void OneOrMore(std::string name, std::vector<double>& field, std::size_t size_max, double min, double max,
                 std::string unit, std::string meaning);

  // Registers a renamed key: `former` is now called `successor` and means the same.
  void Renamed(std::string former, std::string successor);

  // Sets one field. Throws InputError and leaves the field unchanged for an unknown key (names the nearest
  // known one), a renamed key (names the current one), a wrong kind or a value out of range.
  void Apply(const Setting& setting) const;
  // Sets the fields to the values that a log recorded, by former names too. Returns the recorded keys of the
  // table, by their names today. Other recorded keys are ignored. InputError: a value that is not allowed.
  std::set<std::string> ApplyRecorded(const std::map<std::string, std::string>& recorded) const;
  // The current name of a key. `name` may be a former name.
  [[nodiscard]] const std::string& NameToday(const std::string& name) const;

  [[nodiscard]] const std::vector<Key>& keys() const { return keys_; }
  // The current names of renamed keys, by their former names.
  [[nodiscard]] const std::map<std::string, std::string>& successors() const { return successors_; }
  // Each key's default as text, by the key's name.
  [[nodiscard]] std::map<std::string, std::string> Values() const;

 private:
  void Add(Key key);
  void AddChoice(std::string name, std::size_t chosen, std::vector<std::string> choices, std::string meaning,
                 std::function<void(std::size_t chosen)> set);

  std::vector<Key> keys_;
  std::map<std::string, std::string> successors_;  // by the former name
};

// The end of a refusal of `name`: "; did you mean x?", where x is the entry of `names` with the smallest edit
// distance; "" when none is near.
std::string DidYouMean(const std::string& name, const std::vector<std::string>& names);

}  // namespace fovea::config
