// SPDX-License-Identifier: Apache-2.0
// Turns the fields of the servo's settings into keys: a visitor of the field lists in core/config.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <utility>

#include "firmware/core/config/fields.hpp"
#include "firmware/host/config/key_table.hpp"

namespace fovea::config {

class FieldKeys {
 public:
  explicit FieldKeys(KeyTable& keys) : keys_(keys) {}

  // Binds the key of a derived field, or of a choice: `add` adds the key at the field's place in its list.
  // Every derived field with a meaning needs a bound key.
  using Add = std::function<void(KeyTable& keys, const Field& field)>;
  void Bind(const std::string& key, Add add) { bound_[key] = std::move(add); }

  void Flag(const Field& field, bool& value) { keys_.Flag(field.key, value, field.meaning); }
  void Number(const Field& field, double& value, double min, double max) {
    const char* in_motion = field.in_motion == kFixed ? "" : "; may change in motion";
    keys_.Number(field.key, value, min, max, field.unit, field.meaning + std::string(in_motion));
  }
  void Integer(const Field& field, int& value, int min, int max) {
    keys_.Integer(field.key, value, min, max, field.unit, field.meaning);
  }
  template <class Enum, class Names>
  void Choice(const Field& field, Enum& value, const Names& names) {
    if (bound_.count(field.key) > 0) {
      AddBound(field);  // a choice with a further one, such as "auto"
    } else {
      keys_.Choice(field.key, value, names, field.meaning);
    }
  }
  template <class T>
  void PerJoint(const Field& field, T& /*values*/, double /*min*/, double /*max*/) {
    AddBound(field);
  }
  template <class T>
  void Count(const Field& field, T& /*value*/, int /*most*/) {
    AddBound(field);
  }
  template <class T>
  void Derived(const Field& field, T& /*value*/, double /*min*/ = 0.0, double /*max*/ = 0.0) {
    AddBound(field);
  }

 private:
  void AddBound(const Field& field) {
    if (*field.meaning != '\0') {
      bound_.at(field.key)(keys_, field);
    }
  }

  KeyTable& keys_;
  std::map<std::string, Add> bound_;
};

}  // namespace fovea::config
