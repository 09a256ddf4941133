#pragma once
/**
 * @file rolling_case.h
 * @brief A rolling contact case: what the files of config/rolling describe and rolling_contact computes.
 *
 * docs/rolling.md lists the keys. Every pair of a friction coefficient and a lower body is one run.
 */
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "frictional_contact_sim/rolling/creep_curve.h"
#include "frictional_contact_sim/rolling/load_path.h"

namespace frictional_contact_sim
{
enum class FlexibilitySource
{
  BOUNDARY_ELEMENTS,
  HALF_PLANE
};
enum class GapShape
{
  PARABOLA,  ///< x^2/(2R), (5)
  CIRCLE  ///< R - sqrt(R^2 - x^2)
};
enum class Motion
{
  STATIC,  ///< one LCP; slip velocity by (12)
  TRANSIENT,  ///< a sequence of LCPs until steady
  STEADY  ///< the steady state in one LCP
};

struct RollingCase
{
  static constexpr double RIGID = std::numeric_limits<double>::infinity();

  std::string name;
  PlaneStrainMaterial upper;
  std::vector<double> lower_moduli = {RIGID};  ///< Young's moduli of the lower bodies [Pa], RIGID allowed
  double lower_poisson_ratio = 0.1;  ///< [-]
  double radius = 1.0;  ///< R of the cylinder (of the pair for half-planes) [m]
  std::vector<double> friction = {0.3};  ///< mu [-]
  FlexibilitySource source = FlexibilitySource::BOUNDARY_ELEMENTS;
  ContactFrames frames = ContactFrames::CONTOUR;
  GapShape gap = GapShape::PARABOLA;
  int nodes = 50;  ///< contact nodes
  double half_width = 0.0;  ///< of the potential contact zone [m]; 0 = 1.25 a (load), sqrt(2 R d_N) (displacement)
  double datum = 0.0;  ///< of half-planes [m]; 0 = 2 R
  CylinderMesh mesh;  ///< outside the contact zone; the rest is overwritten
  std::optional<Contour> contour;  ///< instead of the cylinder's mesh
  std::optional<double> load;  ///< P [N/m]; else displacements are prescribed
  std::vector<double> load_shares;  ///< Q/(mu P) in (-1, 1), one after another at P, static only; none: Q = 0 [-]
  double normal_displacement = 0.0;  ///< d_N > 0, pressed in [m]
  double tangential_displacement = 0.0;  ///< d_T [m]
  Motion motion = Motion::STATIC;
  double creepage = 0.0;  ///< xi [-]
  double direction = 1.0;  ///< sgn(V) of (12), static only
  int max_steps = 2000;  ///< transient only
  double steady_tolerance = 1e-6;  ///< transient only [-]
  int curve_points = 0;  ///< of the creepage-force curve, 0 = none; needs a load
};

/** @throws std::invalid_argument with one line: file:line, key, what was found, what was expected. */
RollingCase loadRollingCase(const std::string& file);
RollingCase parseRollingCase(const std::string& text, const std::string& name);

struct RollingRun
{
  double friction = 0.0;
  MaterialPair materials;
  ContactFlexibility flexibility;
  Eigen::VectorXd gap;  ///< n [m]
  FrictionalContact contact;
  Eigen::VectorXd slip;  ///< n, slip velocity over V [-]
  std::vector<double> history;  ///< transient, or several loads: Q after each step [N/m]
  std::vector<LoadStep> steps;  ///< several loads: what each has left
  double approach = 0.0, shift = 0.0;  ///< rigid displacements [m]
  bool converged = false;
  double asymmetry = 0.0;  ///< |F - F'|/|F| [-]
  double flexibility_seconds = 0.0, contact_seconds = 0.0;  ///< CPU time [s]
  std::optional<CreepCurve> curve;

  double contactWidth() const;  ///< sum over touching nodes [m]
  double stickWidth() const;  ///< [m]
  double elasticEnergy() const;  ///< 1/2 r' u per width [J/m]
};

struct RunHooks
{
  std::function<void(double share)> progress;  ///< 0 to 1 over all runs
  std::function<bool()> interrupted;
};

/** @throws std::invalid_argument on what the parser could not see, such as contact up to the rim of the zone. */
std::vector<RollingRun> runRollingCase(const RollingCase& study, const RunHooks& hooks = {});

/** @brief NAME_nodes.csv, NAME_runs.csv, NAME_curve_I.yaml into a folder. @return the files' paths */
std::vector<std::string> writeRollingFiles(const RollingCase& study, const std::vector<RollingRun>& runs,
                                           const std::string& folder);

}  // namespace frictional_contact_sim
