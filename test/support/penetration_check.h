#pragma once
/**
 * @file penetration_check.h
 * @brief The independent penetration check of docs/residuals.md: corners, edges and a dense sample of the
 * surface of every collision shape against the solid of every other one and against the ground, at end poses.
 *
 * Shares no code with the narrow phase or the manifolds of collision/ (convex_solid.h). Left out, as the world leaves
 * them out: shapes of one link, links joined by one joint, `disable_collisions`, links that the world names in a
 * warning because they overlap at the start, two shapes that cannot move. A pair that overlaps at the start otherwise
 * is reported as such: the law promises nothing about it.
 *
 * Tolerance: 1e-6 m at rest, max(1e-6 m, h^2 (g + R omega^2)) in motion, R omega^2 of both bodies (R reach from the
 * root, omega the fastest link). A depth is a lower bound: what is found is there.
 */
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "frictional_contact_sim/simulation/simulator.h"
#include "support/convex_solid.h"

namespace frictional_contact_sim
{
namespace test_support
{
struct Penetration
{
  double depth = 0.0;  ///< [m], <= 0 when nothing is found
  double tolerance = 1e-6;  ///< of this pair in this state [m]
  std::string pair;  ///< "body/link - body/link" or "body/link - ground"
  bool excessive() const { return depth > tolerance; }
};

class PenetrationCheck
{
public:
  /** @brief Reads the shapes and, from the present poses, which pairs overlap already. */
  explicit PenetrationCheck(const Simulator& simulator);

  /** @brief Before a step: tolerances are of the faster of its start and its end. */
  void noteSpeeds();
  /** @brief The pair that exceeds its tolerance most, or else the deepest. */
  Penetration worst();
  /** @brief Pairs that overlapped by more than 1e-9 m when the check was made. */
  const std::vector<std::string>& overlapsAtStart() const { return overlaps_; }
  /** @brief Largest speed of a body's coordinates that still counts as rest [m/s] or [rad/s]. */
  static constexpr double REST_SPEED = 1e-4;

private:
  struct Part
  {
    ConvexSolid solid;
    int body, link;
    std::string name;
    Eigen::Isometry3d placement;  ///< in the link
    bool immobile;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< world
    Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< of the bounding sphere, world
  };
  struct Pair
  {
    int a, b;  ///< b = -1: the ground
    double start = 0.0;  ///< depth at the start, if there was any [m]
  };

  void update();
  double spin(int body) const;
  void addPairs();
  bool mayTouch(const Part& a, const Part& b) const;
  bool isDisabled(const Part& a, const std::string& other, int other_body) const;
  double depth(const Pair& pair) const;
  double groundDepth(const Part& part) const;
  double tolerance(const Pair& pair) const;
  std::string name(const Pair& pair) const;

  const Simulator& simulator_;
  double ground_ = 0.0;
  std::vector<Part> parts_;
  std::vector<Pair> pairs_;
  std::vector<double> noted_;  ///< bodies: omega at the start of the step [rad/s]
  std::vector<double> turning_;  ///< bodies: R omega^2 in the step [m/s^2]
  std::vector<char> at_rest_;  ///< bodies
  std::vector<std::string> overlaps_;
};

}  // namespace test_support
}  // namespace frictional_contact_sim
