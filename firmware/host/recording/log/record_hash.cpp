// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/recording/log/record_hash.hpp"

#include <openssl/evp.h>

#include <array>
#include <bit>
#include <cstring>
#include <span>
#include <stdexcept>

namespace fovea::log {
namespace {

static_assert(std::endian::native == std::endian::little,
              "a hash compares across machines only byte by byte");

// Appends values to a byte string; structures are walked field by field, so that padding never counts.
class Writer {
 public:
  explicit Writer(std::vector<std::uint8_t>& bytes) : bytes_(bytes) { bytes_.clear(); }

  template <typename T>
  requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) void operator()(const T& value) {
    Append(&value, sizeof(value));
  }
  template <typename T, std::size_t N>
  requires std::is_arithmetic_v<T>
  void operator()(const std::array<T, N>& values) { Append(values.data(), sizeof(values)); }
  template <typename M>
  void Matrix(const M& m) {
    for (Eigen::Index i = 0; i < m.size(); ++i) {
      (*this)(m.data()[i]);
    }
  }
  template <typename... T>
  void All(const T&... values) {
    ((*this)(values), ...);
  }

 private:
  void Append(const void* from, std::size_t size) {
    const std::size_t old_size = bytes_.size();
    bytes_.resize(old_size + size);
    std::memcpy(bytes_.data() + old_size, from, size);
  }

  std::vector<std::uint8_t>& bytes_;
};

}  // namespace

struct RecordHash::Digest {
  EVP_MD_CTX* context = EVP_MD_CTX_new();
  Digest() {
    if (context == nullptr || EVP_DigestInit_ex(context, EVP_sha256(), nullptr) != 1) {
      EVP_MD_CTX_free(context);
      throw std::runtime_error("OpenSSL cannot compute SHA-256");
    }
  }
  ~Digest() { EVP_MD_CTX_free(context); }
  Digest(const Digest&) = delete;
  Digest& operator=(const Digest&) = delete;

  void Add(const std::vector<std::uint8_t>& bytes) { EVP_DigestUpdate(context, bytes.data(), bytes.size()); }
  std::string Finish() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> hash{};
    unsigned length = 0;
    EVP_DigestFinal_ex(context, hash.data(), &length);
    constexpr const char* kDigits = "0123456789abcdef";
    std::string text;
    for (unsigned i = 0; i < length; ++i) {
      text += kDigits[hash[i] >> 4U];
      text += kDigits[hash[i] & 15U];
    }
    return text;
  }
};

RecordHash::RecordHash() : digest_(std::make_unique<Digest>()) {}
RecordHash::~RecordHash() = default;

void RecordHash::Add(const hal::TickRecord& r) {
  Writer write(bytes_);
  write.All(r.tick, r.stamp_ns, r.missed_ticks);
  write.All(r.arm.stamp_ns, r.arm.sequence, r.arm.num_joints, r.arm.q, r.arm.dq, r.arm.tau_meas,
            r.arm.tau_applied);
  write.All(r.has_feature, r.feature.stamp_ns, r.feature.sequence, r.feature.same_for_ns, r.feature.kind,
            r.feature.found, r.feature.confidence, r.feature.dim, r.feature.s, r.feature.cov_s,
            r.feature.num_poses);
  for (const hal::FlatPose& pose :
       std::span(r.feature.poses).first(static_cast<std::size_t>(r.feature.num_poses))) {
    write.All(pose.p_CO_C, pose.q_CO, pose.first);
  }
  if (r.tuning.result != hal::TuningResult::kNone) {
    write.All(r.tuning.result, r.tuning.key, r.tuning.before, r.tuning.asked);
  }
  write.All(r.intake, r.mode, r.hold_reason, r.fault, r.fault_joint, r.limits_active);
  write.All(r.target_known, r.feature_age_ns, r.p_BO, r.q_BO, r.v_BO, r.stamp_late_s, r.stamp_late_sigma_s);
  write.All(r.dim, r.s, r.s_star, r.e, r.V_BC_C_cmd);
  write.All(r.way.way, r.way.event, r.way.plans_asked, r.way.tries, r.way.outcome, r.way.normal_B);
  write.All(r.q_cmd, r.dq_cmd, r.ddq_cmd, r.tau_ext);
  write.All(r.command.state_sequence, r.command.num_joints, r.command.tau_cmd, r.command.engage_brakes);
  digest_->Add(bytes_);
}

std::string RecordHash::Finish() { return digest_->Finish(); }

std::string HashOfModel(const model::ArmModel& model) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(sizeof model);
  Writer write(bytes);
  write.All(std::int32_t{model.num_joints});
  for (std::size_t i = 0; i < static_cast<std::size_t>(model.num_joints); ++i) {
    const model::Joint& j = model.joints[i];
    write(j.type);
    write.Matrix(j.X_PJ.R);
    write.Matrix(j.X_PJ.p);
    write.All(j.q_min, j.q_max, j.dq_max, j.ddq_max, j.dddq_max, j.tau_max, j.dtau_max, j.viscous, j.coulomb,
              j.rotor_inertia, j.spring);
    write(model.links[i].mass);
    write.Matrix(model.links[i].p_LiCom);
    write.Matrix(model.links[i].I_Com_Li);
    write(model.q_ready[i]);
  }
  write.Matrix(model.X_LnE.R);
  write.Matrix(model.X_LnE.p);
  write.Matrix(model.g_B);
  for (const model::Capsule& body : model.shape.bodies) {
    write.Matrix(body.p_LA);
    write.Matrix(body.p_LB);
    write(body.radius);
  }
  write.All(std::int32_t{model.shape.num_pairs});
  for (const model::ArmShape::Pair& pair : model.shape.pairs) {
    write.All(pair.near, pair.far);
  }
  RecordHash::Digest digest;
  digest.Add(bytes);
  return digest.Finish();
}

}  // namespace fovea::log
