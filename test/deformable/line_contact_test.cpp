// Finite elements pressed and sheared against Hertz, Cattaneo and Mindlin, and against the half-planes of the module
// rolling: graded meshes, one quasi-static load step, nodal forces beside integrals of the tractions.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <vector>

#include "frictional_contact_sim/rolling/closed_forms.h"
#include "frictional_contact_sim/rolling/frictional_lcp.h"
#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double RADIUS = 1.0;  ///< of the cylinder, or of the pair [m]
constexpr double HALF_WIDTH = 0.001;  ///< about that of the contact [m]; a/R is what half-planes leave out
constexpr double REACH = 60.0;  ///< half width and depth of a block over HALF_WIDTH
constexpr double YOUNG = 1.0e6;
constexpr double POISSON = 0.3;
constexpr double FRICTION = 0.3;
const PlaneStrainMaterial RUBBER{YOUNG, POISSON};

/** 0 = t_0 < ... < t_n, finest at 0 with REACH asinh(REACH)/n cells over HALF_WIDTH: halved as n doubles [m]. */
std::vector<double> graded(int n)
{
  std::vector<double> places;
  for (int k = 0; k <= n; ++k)
    places.push_back(HALF_WIDTH * std::sinh(std::asinh(REACH) * k / n));
  return places;
}

/** Abscissae of the nodes of the surface, from left to right [m]. */
std::vector<double> surfaceNodes(int n)
{
  const std::vector<double> right = graded(n);
  std::vector<double> x;
  for (int k = n; k > 0; --k)
    x.push_back(-right[k]);
  x.insert(x.end(), right.begin(), right.end());
  return x;
}

/** A rectangle below z = 0 (side -1), or above the parabola x^2/(2 R) (side 1), as a file of Gmsh; mirror symmetric. */
std::string writeBlock(const std::string& file, int n, double side)
{
  const std::vector<double> x = surfaceNodes(n);
  const std::vector<double> depth = graded(n);
  const auto columns = static_cast<int>(x.size());
  std::ofstream out(file);
  out.precision(17);
  out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" << columns * (n + 1) << '\n';
  for (int k = 0; k <= n; ++k)
    for (int i = 0; i < columns; ++i)
    {
      const double bulge = side > 0.0 ? x[i] * x[i] / (2.0 * RADIUS) * (1.0 - depth[k] / depth.back()) : 0.0;
      out << k * columns + i + 1 << ' ' << x[i] << ' ' << side * depth[k] + bulge << " 0\n";
    }
  out << "$EndNodes\n$Elements\n" << 2 * (columns - 1) * n << '\n';
  int count = 0;
  const auto triangle = [&](int a, int b, int c)
  { out << ++count << " 2 2 0 1 " << a << ' ' << b << ' ' << c << '\n'; };
  for (int k = 0; k < n; ++k)
    for (int i = 0; i + 1 < columns; ++i)
    {
      const int corner = k * columns + i + 1;
      const int below = corner + columns;
      if (i < n)  // diagonals lean towards the middle
      {
        triangle(corner, corner + 1, below);
        triangle(corner + 1, below + 1, below);
      }
      else
      {
        triangle(corner, corner + 1, below + 1);
        triangle(corner, below + 1, below);
      }
    }
  out << "$EndElements\n";
  return file;
}

std::string elasticBody(const std::string& name, const std::string& mesh, const std::string& fixed)
{
  return "  - name: " + name + "\n    elastic: {mesh: " + mesh + ", young_modulus: " + std::to_string(YOUNG) +
         ", poisson_ratio: " + std::to_string(POISSON) + ", density: 1000, fixed: [" + fixed + "]}\n";
}

/** What the lower body's surface carries after one load step. */
struct Pressed
{
  std::vector<double> x;  ///< nodes [m]
  Eigen::VectorXd normal, tangential;  ///< nodal forces on the lower body, down and to the right, per width [N/m]
  double P = 0.0, Q = 0.0;
  double cell = 0.0;  ///< the finest [m]
};

class LineContactTest : public testing::Test
{
protected:
  void SetUp() override
  {
    folder_ = std::filesystem::temp_directory_path() / ("line_contact_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  /** @param shift, approach of the upper body [m] */
  Pressed press(int n, double friction, double shift, double approach, bool is_upper_elastic) const
  {
    std::string yaml = "quasi_static: true\ntime_step: 1\ngravity: [0, 0, 0]\nmaterials: {default: {friction: " +
                       std::to_string(friction) + "}}\nbodies:\n" +
                       elasticBody("lower", writeBlock(folder_ / "lower.msh", n, -1.0), "bottom");
    if (is_upper_elastic)
      yaml += elasticBody("upper", writeBlock(folder_ / "upper.msh", n, 1.0), "top");
    Scenario scenario = loadScenario(yaml, "line contact");
    if (!is_upper_elastic)
    {
      BodySpec cylinder;  // nodes lie in the plane y = 0, where a sphere is a cylinder
      cylinder.name = "upper";
      cylinder.base = BaseType::FIXED;
      cylinder.urdf_xml =
          "<robot name='c'><link name='c'><inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' "
          "izz='1'/></inertial><collision><geometry><sphere radius='" +
          std::to_string(RADIUS) + "'/></geometry></collision></link></robot>";
      cylinder.pose = Eigen::Isometry3d(Eigen::Translation3d(0.0, 0.0, RADIUS));
      scenario.bodies.push_back(cylinder);
    }
    scenario.bodies[1].motion = BaseMotion(Eigen::Vector3d(shift, 0.0, -approach), Eigen::Vector3d::Zero());
    Simulator simulator(scenario);
    EXPECT_TRUE(simulator.step().converged()) << simulator.outcome().message;
    return readForces(simulator, n);
  }

private:
  static Pressed readForces(const Simulator& simulator, int n)
  {
    Pressed result;
    result.x = surfaceNodes(n);
    result.cell = result.x[n + 1];
    const auto size = static_cast<Eigen::Index>(result.x.size());
    result.normal = result.tangential = Eigen::VectorXd::Zero(size);
    for (const ContactState& contact : simulator.contacts())
    {
      // Displacements are far below half a cell.
      const auto right = std::lower_bound(result.x.begin(), result.x.end(), contact.position.x());
      auto node = static_cast<size_t>(std::min<std::ptrdiff_t>(right - result.x.begin(), size - 1));
      if (node > 0 && contact.position.x() - result.x[node - 1] < result.x[node] - contact.position.x())
        --node;
      const double sign = simulator.shape(contact.shape_a).body == 0 ? 1.0 : -1.0;
      const Eigen::Vector3d force = sign * contact.impulse / simulator.scenario().time_step;
      result.normal[static_cast<Eigen::Index>(node)] -= force.z();
      result.tangential[static_cast<Eigen::Index>(node)] += force.x();
    }
    result.P = result.normal.sum();
    result.Q = result.tangential.sum();
    return result;
  }

  std::filesystem::path folder_;
};

/** Sum over nodes of |force - integral of traction times hat function|, over the scale. */
double forceError(const Pressed& pressed, const Eigen::VectorXd& force, const std::function<double(double)>& traction,
                  double scale)
{
  constexpr int POINTS = 400;  // of the midpoint rule: square-root ends
  double error = 0.0;
  for (size_t i = 1; i + 1 < pressed.x.size(); ++i)
  {
    double exact = 0.0;
    for (const int side : {-1, 1})
    {
      const double length = std::abs(pressed.x[i + side] - pressed.x[i]);
      for (int k = 0; k < POINTS; ++k)
      {
        const double share = (k + 0.5) / POINTS;
        exact += traction(pressed.x[i] + side * share * length) * (1.0 - share) * length / POINTS;
      }
    }
    error += std::abs(force[static_cast<Eigen::Index>(i)] - exact);
  }
  return error / scale;
}

/** Length of the nodes' cells that `accept` takes [m]. */
double width(const Pressed& pressed, const std::function<bool(size_t)>& accept)
{
  double sum = 0.0;
  for (size_t i = 1; i + 1 < pressed.x.size(); ++i)
    sum += accept(i) ? 0.5 * (pressed.x[i + 1] - pressed.x[i - 1]) : 0.0;
  return sum;
}

/** Orders between runs whose cells are halved. */
void expectOrder(const std::vector<double>& errors, double least)
{
  for (size_t k = 1; k < errors.size(); ++k)
    EXPECT_GT(std::log2(errors[k - 1] / errors[k]), least) << errors[k - 1] << " then " << errors[k];
}

TEST_F(LineContactTest, RigidCylinderOnABlockIsHertz)
{
  // Sums of |nodal force - integral of the pressure| over P. Square-root ends: order 1.5, as the module rolling's; the
  // half-width is right to a cell at each end, the pressure in the middle is the mean of three cells.
  const double reduced = YOUNG / (1.0 - POISSON * POISSON);
  std::vector<double> errors;
  for (const int n : {20, 40, 80})
  {
    const Pressed pressed = press(n, 0.0, 0.0, 3.0 * HALF_WIDTH * HALF_WIDTH / RADIUS, false);
    const HertzLine hertz = hertzLine(pressed.P, RADIUS, reduced);
    const double touching =
        width(pressed, [&](size_t i) { return pressed.normal[static_cast<Eigen::Index>(i)] > 0.0; });
    EXPECT_NEAR(touching, 2.0 * hertz.half_width, 2.0 * pressed.cell * std::hypot(1.0, hertz.half_width / HALF_WIDTH));
    const double middle = pressed.normal.segment(n - 1, 3).sum() / (pressed.x[n + 1] - pressed.x[n - 1] + pressed.cell);
    EXPECT_NEAR(middle, hertz.peak_pressure, 0.05 * hertz.peak_pressure * 20 / n);
    errors.push_back(forceError(
        pressed, pressed.normal, [&](double x) { return hertz.pressure(x); }, pressed.P));
  }
  expectOrder(errors, 1.0);
  EXPECT_LT(errors.back(), 0.01);
}

TEST_F(LineContactTest, EqualBlocksAreCattaneoAndMindlin)
{
  // Pressed and sheared in one step: where the direction of slip does not change that is P first, then Q. Both
  // surfaces' nodes touch facets of the other, so a place has two contacts; what counts is their sum. It sticks where
  // that is within the cone. Order one, as the edge of the stick zone comes by whole cells.
  const double reduced = 0.5 * YOUNG / (1.0 - POISSON * POISSON);
  for (const double share : {0.2})
  {
    for (const int n : {20, 40})
    {
      const double approach = 6.0 * HALF_WIDTH * HALF_WIDTH / RADIUS;
      const Pressed pressed = press(n, FRICTION, share * approach, approach, true);
      const HertzLine hertz = hertzLine(pressed.P, RADIUS, reduced);
      const double load_share = pressed.Q / (FRICTION * pressed.P);
      EXPECT_GT(load_share, 0.15);
      const auto isSticking = [&](size_t i)
      {
        const auto k = static_cast<Eigen::Index>(i);
        return pressed.tangential[k] < 0.98 * FRICTION * pressed.normal[k];
      };
      const double exact = 2.0 * cattaneoStickHalfWidth(hertz, load_share);
      EXPECT_NEAR(width(pressed, isSticking), exact,
                  4.0 * pressed.cell * std::hypot(1.0, hertz.half_width / HALF_WIDTH))
          << n;
      const double error = forceError(
          pressed, pressed.tangential, [&](double x) { return cattaneoTraction(hertz, FRICTION, load_share, x); },
          FRICTION * pressed.P);
      EXPECT_LT(error, 1.6 / n) << n;
    }
  }
}

TEST_F(LineContactTest, RigidCylinderWithFrictionIsTheHalfPlaneOfTheModuleRolling)
{
  // Coupled materials (beta = 0.29), no closed form: the same loads in one step on strips at the nodes' places.
  const MaterialPair pair{RUBBER, {}, true};
  std::vector<double> errors;
  for (const int n : {20, 40, 80})
  {
    const double approach = 3.0 * HALF_WIDTH * HALF_WIDTH / RADIUS;
    const Pressed pressed = press(n, FRICTION, 0.15 * approach, approach, false);
    std::vector<Eigen::Index> near;
    for (Eigen::Index i = 1; i + 1 < pressed.normal.size(); ++i)
      if (std::abs(pressed.x[i]) < 2.0 * HALF_WIDTH)
        near.push_back(i);
    Eigen::VectorXd x(near.size());
    Eigen::VectorXd strip(near.size());
    for (size_t k = 0; k < near.size(); ++k)
    {
      x[k] = pressed.x[near[k]];
      strip[k] = 0.5 * (pressed.x[near[k] + 1] - pressed.x[near[k] - 1]);
    }
    const FrictionalLcp lcp(halfPlaneFlexibility(pair, x, strip, REACH * HALF_WIDTH),
                            Eigen::VectorXd::Constant(1, FRICTION));
    LoadTarget target;
    target.P = pressed.P;
    target.Q = pressed.Q;
    const LoadedContact rolling =
        solveForLoads(lcp, x.array().square() / (2.0 * RADIUS), Eigen::VectorXd::Zero(x.size()), target, approach, 0.0);
    ASSERT_TRUE(rolling.converged);
    double difference = 0.0;
    for (size_t k = 0; k < near.size(); ++k)
      difference += std::hypot(pressed.normal[near[k]] - strip[k] * rolling.contact.r_N[k],
                               pressed.tangential[near[k]] - strip[k] * rolling.contact.r_T[k]);
    errors.push_back(difference / pressed.P);
  }
  expectOrder(errors, 0.5);
  EXPECT_LT(errors.back(), 0.01);
}

}  // namespace
}  // namespace frictional_contact_sim
