// SPDX-License-Identifier: Apache-2.0
// The C functions of the model library that the robot sends on LoadModelLibrary: kinematics and dynamics of a
// Panda. Arrays are column-major; Jacobians are [6 x 7], linear first; "load" is everything on the flange.
#pragma once

extern "C" {

// Poses in O of the links' frames 1 to 7, of the flange (8), and of the end effector (9).
void O_T_J1(const double* q, double* pose);
void O_T_J2(const double* q, double* pose);
void O_T_J3(const double* q, double* pose);
void O_T_J4(const double* q, double* pose);
void O_T_J5(const double* q, double* pose);
void O_T_J6(const double* q, double* pose);
void O_T_J7(const double* q, double* pose);
void O_T_J8(const double* q, double* pose);
void O_T_J9(const double* q, const double* F_T_EE, double* pose);

// Their Jacobians, in axes of O.
void O_J_J1(double* jacobian);
void O_J_J2(const double* q, double* jacobian);
void O_J_J3(const double* q, double* jacobian);
void O_J_J4(const double* q, double* jacobian);
void O_J_J5(const double* q, double* jacobian);
void O_J_J6(const double* q, double* jacobian);
void O_J_J7(const double* q, double* jacobian);
void O_J_J8(const double* q, double* jacobian);
void O_J_J9(const double* q, const double* F_T_EE, double* jacobian);

// The same Jacobians, in axes of the frame itself.
void Ji_J_J1(double* jacobian);
void Ji_J_J2(const double* q, double* jacobian);
void Ji_J_J3(const double* q, double* jacobian);
void Ji_J_J4(const double* q, double* jacobian);
void Ji_J_J5(const double* q, double* jacobian);
void Ji_J_J6(const double* q, double* jacobian);
void Ji_J_J7(const double* q, double* jacobian);
void Ji_J_J8(const double* q, double* jacobian);
void Ji_J_J9(const double* q, const double* F_T_EE, double* jacobian);

// Mass matrix [7 x 7], Coriolis and centrifugal torques, and the torques that hold the arm against gravity
// `g_earth`.
void M_NE(const double* q, const double* I_load, double m_load, const double* F_x_Cload, double* M);
void c_NE(const double* q, const double* dq, const double* I_load, double m_load, const double* F_x_Cload,
          double* c);
void g_NE(const double* q, const double* g_earth, double m_load, const double* F_x_Cload, double* g);

}  // extern "C"
