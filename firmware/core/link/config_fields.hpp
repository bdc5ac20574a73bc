// SPDX-License-Identifier: Apache-2.0
// The servo's configuration as bytes: the field lists of core/config, for any archive of fields.hpp.
#pragma once

#include <cstddef>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/link/fields.hpp"

namespace fovea::link {

// A visitor of the field lists that passes each value to `archive`.
template <class Archive>
class FieldsOf {
 public:
  explicit FieldsOf(Archive& archive) noexcept : archive_(archive) {}

  template <class T>
  void Flag(const config::Field& /*field*/, T& value) noexcept {
    archive_(value);
  }
  template <class T>
  void Number(const config::Field& /*field*/, T& value, double /*min*/, double /*max*/) noexcept {
    archive_(value);
  }
  template <class T>
  void Integer(const config::Field& /*field*/, T& value, int /*min*/, int /*max*/) noexcept {
    archive_.Int(value);
  }
  template <class T, class Names>
  void Choice(const config::Field& /*field*/, T& value, const Names& names) noexcept {
    archive_.Choice(value, static_cast<int>(names.size()));
  }
  template <class T>
  void PerJoint(const config::Field& /*field*/, T& values, double /*min*/, double /*max*/) noexcept {
    EachOf(archive_, values);
  }
  template <class T>
  void Count(const config::Field& /*field*/, T& value, int most) noexcept {
    archive_.Count(value, most);
  }
  template <class T>
  void Derived(const config::Field& /*field*/, T& value, double /*min*/ = 0.0,
               double /*max*/ = 0.0) noexcept {
    if constexpr (requires { value.size(); }) {
      Entries(archive_, value);
    } else {
      archive_(value);
    }
  }

 private:
  Archive& archive_;
};

// Calls `visit(name, fields)` for each section of `c` but the arm. `fields(archive)` visits its fields.
template <class Config, class Visit>
void EachSection(Config& c, const Visit& visit) noexcept {
  config::EachSection(c, [&visit](const char* name, const auto& fields) {
    visit(name, [&fields](auto& archive) {
      FieldsOf visitor(archive);
      fields(visitor);
    });
  });
}

template <class Archive, class T>
void ServoFields(Archive& a, T& c) noexcept {
  FieldsOf visitor(a);
  config::Fields(visitor, c);
}

template <class Archive, class T>
void ArmFields(Archive& a, T& arm) noexcept {
  a.Count(arm.num_joints, model::kMaxJoints);
  for (auto& j : arm.joints) {
    a.Choice(j.type, 2);
    PoseFields(a, j.X_PJ);
    a(j.q_min);
    a(j.q_max);
    a(j.dq_max);
    a(j.ddq_max);
    a(j.dddq_max);
    a(j.tau_max);
    a(j.dtau_max);
    a(j.viscous);
    a(j.coulomb);
    a(j.spring);
  }
  for (auto& link : arm.links) {
    a(link.mass);
    Entries(a, link.p_LiCom);
    Entries(a, link.I_Com_Li);
  }
  PoseFields(a, arm.X_LnE);
  Entries(a, arm.g_B);
  EachOf(a, arm.q_ready);
  for (auto& body : arm.shape.bodies) {
    Entries(a, body.p_LA);
    Entries(a, body.p_LB);
    a(body.radius);
  }
  a.Count(arm.shape.num_pairs, model::ArmShape::kMostPairs);
  for (auto& pair : arm.shape.pairs) {
    a.Count(pair.near, model::ArmShape::kMostBodies - 1);
    a.Count(pair.far, model::ArmShape::kMostBodies - 1);
  }
  for (auto& j : arm.joints) {  // last, so that a log without them can be read
    a(j.rotor_inertia);
  }
}

}  // namespace fovea::link
