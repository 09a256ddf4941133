#pragma once
/**
 * @file law_scale.h
 * @brief What a simulation knows of the velocities at a law's rows, and a bare problem does not; used by
 * residual_metric.h.
 */
namespace frictional_contact_sim
{
/** @brief What a row's velocity is: only rows of one unit are compared with each other. */
enum class VelocityUnit : unsigned char
{
  LENGTH,  ///< [m/s]
  ANGLE,  ///< [rad/s]
  SLACK  ///< of a servo beyond its effort limit, [m/s] or [rad/s]: as large as its position error over the time step
};

/** @brief What a simulation knows of the bodies that a law's rows touch. */
struct LawScale
{
  VelocityUnit unit = VelocityUnit::LENGTH;
  double reach = 1.0;  ///< farthest point from the axis that rows of angles move [m]; 1 for rows of lengths
  double speed_change = 0.0;  ///< S_0 of these bodies, as a speed of points [m/s]
  double speed = 0.0;  ///< the fastest point of these bodies [m/s]: u is not known better than its round-off
};

}  // namespace frictional_contact_sim
