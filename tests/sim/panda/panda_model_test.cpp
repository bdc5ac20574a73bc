// SPDX-License-Identifier: Apache-2.0
// The model library's C functions compared with the model from the URDF.
#include "sim/model_library/panda_model.hpp"

#include <gtest/gtest.h>

#include <random>

#include "firmware/core/model/dynamics.hpp"
#include "firmware/core/model/load.hpp"
#include "firmware/host/robots/robot.hpp"
#include "tests/support/places.hpp"

namespace fovea::test {
namespace {

using Matrix4 = Eigen::Matrix4d;
using Matrix67 = Eigen::Matrix<double, 6, 7>;
using Matrix7 = Eigen::Matrix<double, 7, 7>;
using Vector7 = Eigen::Matrix<double, 7, 1>;

class PandaModel : public testing::Test {
 protected:
  Vector7 Random() {
    Vector7 v;
    for (double& x : v) {
      x = even_(random_);
    }
    return v;
  }
  robots::Robot panda_ = robots::LoadRobot(test::RobotsFolder() + "/panda.toml");
  std::mt19937_64 random_{3};
  std::uniform_real_distribution<double> even_{-2.0, 2.0};
};

TEST_F(PandaModel, DynamicsMatchTheUrdfWithItsLoad) {
  model::Load load;
  load.mass = 0.7;
  load.p_ECom = {0.01, -0.02, 0.05};
  load.I_Com_E << 2e-3, 1e-4, 0, 1e-4, 3e-3, 2e-4, 0, 2e-4, 1e-3;
  double worst = 0.0;
  for (const bool loaded : {false, true}) {
    model::ArmModel arm = panda_.model;
    if (loaded) {
      model::Attach(load, arm);
    }
    for (int k = 0; k < 100; ++k) {
      const Vector7 q = Random();
      const Vector7 dq = Random();
      model::ArmPoses poses;
      model::ArmDynamics expected;
      model::ComputePoses(arm, q, poses);
      model::ComputeDynamics(arm, poses, dq, expected);
      const double mass = loaded ? load.mass : 0.0;
      const model::Vec3 g_earth{0.0, 0.0, -9.81};
      Matrix7 M;
      Vector7 c;
      Vector7 g;
      M_NE(q.data(), load.I_Com_E.data(), mass, load.p_ECom.data(), M.data());
      c_NE(q.data(), dq.data(), load.I_Com_E.data(), mass, load.p_ECom.data(), c.data());
      g_NE(q.data(), g_earth.data(), mass, load.p_ECom.data(), g.data());
      worst = std::max({worst, (M - expected.M).cwiseAbs().maxCoeff(),
                        (c - expected.Cdq).cwiseAbs().maxCoeff(), (g - expected.g).cwiseAbs().maxCoeff()});
    }
  }
  std::cout << "largest difference " << worst << " Nm\n";
  EXPECT_EQ(worst, 0.0) << "both must be bit-identical";
}

TEST_F(PandaModel, PosesMatchTheUrdf) {
  const Vector7 q = Random();
  model::ArmPoses poses;
  model::ComputePoses(panda_.model, q, poses);
  using Function = void (*)(const double*, double*);
  const Function functions[] = {O_T_J1, O_T_J2, O_T_J3, O_T_J4, O_T_J5, O_T_J6, O_T_J7, O_T_J8};
  for (std::size_t i = 0; i < 8; ++i) {
    Matrix4 X;
    functions[i](q.data(), X.data());
    const model::Pose& expected = i < 7 ? poses.X_BL[i] : poses.X_BE;
    EXPECT_LT((X.topLeftCorner<3, 3>() - expected.R).cwiseAbs().maxCoeff(), 1e-15) << i;
    EXPECT_LT((X.topRightCorner<3, 1>() - expected.p).cwiseAbs().maxCoeff(), 1e-15) << i;
    EXPECT_EQ(X.row(3), Eigen::RowVector4d(0, 0, 0, 1));
  }
}

// The Jacobian of the end effector against pose differences, and in its own axes.
TEST_F(PandaModel, JacobiansMatchFiniteDifferencesOfPoses) {
  const Vector7 q = Random();
  Matrix4 tool = Matrix4::Identity();
  tool.topLeftCorner<3, 3>() << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  tool.topRightCorner<3, 1>() << 0.05, 0.0, 0.1034;
  Matrix67 J;
  Matrix67 J_own;
  Matrix4 X;
  O_J_J9(q.data(), tool.data(), J.data());
  Ji_J_J9(q.data(), tool.data(), J_own.data());
  O_T_J9(q.data(), tool.data(), X.data());
  constexpr double kStep = 1e-6;
  double worst = 0.0;
  for (int i = 0; i < 7; ++i) {
    Matrix4 before;
    Matrix4 after;
    O_T_J9(Vector7(q - kStep * Vector7::Unit(i)).data(), tool.data(), before.data());
    O_T_J9(Vector7(q + kStep * Vector7::Unit(i)).data(), tool.data(), after.data());
    const Matrix4 dX = (after - before) / (2 * kStep);
    const Eigen::Matrix3d W = dX.topLeftCorner<3, 3>() * X.topLeftCorner<3, 3>().transpose();
    Eigen::Matrix<double, 6, 1> twist;
    twist << dX.topRightCorner<3, 1>(), W(2, 1), W(0, 2), W(1, 0);
    worst = std::max(worst, (J.col(i) - twist).cwiseAbs().maxCoeff());
  }
  std::cout << "largest difference " << worst << '\n';
  EXPECT_LT(worst, 1e-9);
  const Eigen::Matrix3d R = X.topLeftCorner<3, 3>();
  EXPECT_LT((R * J_own.topRows<3>() - J.topRows<3>()).cwiseAbs().maxCoeff(), 1e-15);
  EXPECT_LT((R * J_own.bottomRows<3>() - J.bottomRows<3>()).cwiseAbs().maxCoeff(), 1e-15);
}

TEST_F(PandaModel, JointsFurtherOutDoNotMoveALink) {
  const Vector7 q = Random();
  Matrix67 J;
  O_J_J1(J.data());
  EXPECT_EQ(J.col(0).tail<3>(), Eigen::Vector3d::UnitZ());
  EXPECT_TRUE(J.rightCols<6>().isZero(0.0));
  O_J_J4(q.data(), J.data());
  EXPECT_TRUE(J.rightCols<3>().isZero(0.0));
  EXPECT_NEAR(J.col(3).tail<3>().norm(), 1.0, 1e-15);
  Ji_J_J1(J.data());
  EXPECT_EQ(J.col(0).tail<3>(), Eigen::Vector3d::UnitZ());
}

}  // namespace
}  // namespace fovea::test
