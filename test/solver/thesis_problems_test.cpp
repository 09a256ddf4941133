/**
 * @file thesis_problems_test.cpp
 * @brief The exact cases of Cadoux (2009), sections 1.4 and 3.3, by every method: CONVERGED only where the independent
 * validator confirms it, the closed form where it is reached, an honest status where no solution exists.
 */
#include <gtest/gtest.h>

#include <set>

#include "judgement.h"
#include "support/hand_problems.h"
#include "support/thesis_problems.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;

namespace
{
constexpr double DEGREE = M_PI / 180.0;
/// Residual 1e-8 on problems whose numbers are of order one: v is known to the residual times a condition below 100.
constexpr double VELOCITY = 1e-6;
/// The rod's normal row is sin(theta) > 0.17 and tan(theta) - mu > 0.05 away from zero: r is known to 1e-8/0.01.
constexpr double IMPULSE = 1e-5;

using Names = std::set<std::string>;

Solution guessOf(const Eigen::VectorXd& r)
{
  Solution guess;
  guess.r = r;
  return guess;
}

/// All registry keys but some.
Names allBut(const Names& exceptions)
{
  Names names;
  for (const SolverEntry& entry : solverRegistry())
    if (exceptions.count(entry.name) == 0)
      names.insert(entry.name);
  return names;
}

/// Every method is judged, those of `must` have to converge; check(result) on every CONVERGED.
template <typename Check>
void forEverySolver(const IncrementalProblem& problem, const std::string& what, const Names& must, Check check,
                    const Solution* guess = nullptr)
{
  for (const SolverEntry& entry : solverRegistry())
  {
    SCOPED_TRACE(std::string(entry.name) + " on " + what);
    const SolverResult result = solveAndJudge(entry, problem, what, guess);
    if (must.count(entry.name) > 0)
    {
      EXPECT_EQ(result.status, SolverStatus::CONVERGED) << result.message << " E = " << result.residual;
    }
    if (result.status == SolverStatus::CONVERGED)
      check(result);
  }
}

void expectNoneConverges(const IncrementalProblem& problem, const std::string& what)
{
  forEverySolver(problem, what, {},
                 [](const SolverResult& result) {
                   ADD_FAILURE() << "converged although there is no solution, r = " << result.solution.r.transpose();
                 });
}

/// The closed form of a sliding rod: r_y = tan / (tan -+ mu) for gravity down, (1.44), (1.45).
Eigen::Vector2d slidingRod(double angle, double friction, double support_velocity)
{
  const double slip = support_velocity > 0.0 ? 1.0 : -1.0;
  const double normal = std::tan(angle) / (std::tan(angle) - slip * friction);
  return normal * Eigen::Vector2d(1.0, -slip * friction);
}
}  // namespace

TEST(PainleveRodTest, WithoutParadoxThereIsOneSlidingSolution)
{
  // Lemma 1.3. The fixed point on the thresholds repels where the friction pulls the rod into the ground (thesis: H-pf
  // needs a contraction), so haslinger and ac_fixed_point, which follow it, need not arrive; interior_point's change of
  // s is that of a fixed point as well. fb_bfgs meets a local minimum of its merit function (thesis, 4.5).
  const Names must = allBut({"haslinger", "ac_fixed_point", "interior_point", "cadoux_fixed_point", "fb_bfgs"});
  for (const double friction : {0.3, 1.0, 2.0})
    for (const double degrees : {10.0, 30.0, 50.0, 70.0})
      for (const double support : {-1.0, -0.1, 0.1, 1.0})
      {
        const double angle = degrees * DEGREE;
        if (support > 0.0 && std::tan(angle) < friction + 0.05)
          continue;
        const Eigen::Vector2d expected = slidingRod(angle, friction, support);
        forEverySolver(painleveRod(angle, friction, -1.0, support),
                       "rod at " + std::to_string(degrees) + " degrees, mu " + std::to_string(friction) + ", u_0 " +
                           std::to_string(support),
                       must,
                       [&](const SolverResult& result)
                       {
                         EXPECT_NEAR(result.solution.v[0], 0.0, VELOCITY);
                         EXPECT_LT((result.solution.r - expected).norm(), IMPULSE * expected.norm());
                       });
      }
}

TEST(PainleveRodTest, InTheParadoxNoSolutionExistsAndNobodyFindsOne)
{
  for (const double friction : {1.0, 2.0})
    for (const double degrees : {10.0, 30.0, 40.0})
      expectNoneConverges(painleveRod(degrees * DEGREE, friction, -1.0, 1.0),
                          "rod at " + std::to_string(degrees) + " degrees, mu " + std::to_string(friction));
}

TEST(PainleveRodTest, GravityUpwardsTheRodTakesOffOrSlides)
{
  // Lemma 1.2: take-off v = sin(theta) always; with tan(theta) < mu also sliding, r_y = tan / (mu - tan), v = 0.
  for (const double degrees : {10.0, 30.0, 60.0, 75.0})
  {
    const double angle = degrees * DEGREE, tangent = std::tan(angle), friction = 2.0;
    const IncrementalProblem rod = painleveRod(angle, friction, 1.0, 1.0);
    const std::string what = "rod at " + std::to_string(degrees) + " degrees, gravity upwards";
    const auto takesOff = [&](const SolverResult& result)
    {
      EXPECT_NEAR(result.solution.v[0], std::sin(angle), VELOCITY);
      EXPECT_LT(result.solution.r.norm(), IMPULSE);
    };
    forEverySolver(rod, what, allBut({}), takesOff);
    const double normal = tangent / (friction - tangent);
    const Eigen::Vector2d sliding = normal * Eigen::Vector2d(1.0, -friction);
    const double verdict = validateAnswer(rod, Eigen::VectorXd::Zero(1), sliding, Eigen::VectorXd(0)).worst();
    if (tangent > friction)
    {
      EXPECT_GT(verdict, 0.1);  // r_y < 0: no second solution
      continue;
    }
    EXPECT_LT(verdict, 1e-14);  // eps |r|/rho / S is the least that is ever reported: 2.2e-15 at 60 degrees
    const Solution guess = guessOf(0.99 * sliding);
    forEverySolver(
        rod, what + ", from near the sliding solution", {"portfolio", "ac_newton", "ds_newton", "fb_newton"},
        [&](const SolverResult& result)
        {
          if (result.solution.v[0] > 0.01)
            takesOff(result);
          else
            EXPECT_LT((result.solution.r - sliding).norm(), IMPULSE * normal);
        },
        &guess);
    const SolverResult nearest = createSolver("portfolio")->solve(rod, &guess);
    EXPECT_LT((nearest.solution.r - sliding).norm(), IMPULSE * normal) << what << ": the nearer solution is expected";
  }
}

TEST(PainleveRodTest, AStillSupportSticksWithManyImpulses)
{
  // u_0 = 0, gravity down: v = 0 and r anywhere on sin r_y + cos r_x = sin within the cone.
  for (const double degrees : {20.0, 45.0, 80.0})
  {
    const double angle = degrees * DEGREE;
    forEverySolver(painleveRod(angle, 0.7, -1.0, 0.0), "rod at rest", allBut({}),
                   [&](const SolverResult& result)
                   {
                     EXPECT_NEAR(result.solution.v[0], 0.0, VELOCITY);
                     EXPECT_NEAR(result.solution.r.dot(Eigen::Vector2d(std::sin(angle), std::cos(angle))),
                                 std::sin(angle), VELOCITY);
                   });
  }
}

TEST(Example321Test, EveryMethodFindsTheTrueSolution)
{
  const auto isTrue = [](const SolverResult& result)
  {
    EXPECT_LT((result.solution.v - Eigen::Vector2d(0, -1)).norm(), VELOCITY) << "the false fixed point is v = 0";
    EXPECT_LT(result.solution.r.norm(), VELOCITY);
  };
  forEverySolver(example321(), "example 3.21", allBut({}), isTrue);
  // From a guess that slips, s is not zero there; and from one along the direction of recession of s = 0. Methods that
  // follow a merit function may run along that ray to where E, relative to |r|, falls below any tolerance: not asked.
  const Solution slipping = guessOf(Eigen::Vector3d(0.3, 0.0, -0.2)), recession = guessOf(Eigen::Vector3d(2, -2, 0.5));
  forEverySolver(example321(), "example 3.21 from a guess", {"portfolio", "ac_newton"}, isTrue, &slipping);
  for (const char* name : {"portfolio", "ac_newton", "gauss_seidel", "ds_fixed_point"})
  {
    const SolverResult result = createSolver(name)->solve(example321(), &recession);
    EXPECT_EQ(result.status, SolverStatus::CONVERGED) << name;
    isTrue(result);
  }
}

TEST(Example321Test, TheFalseFixedPointIsNoAnswer)
{
  // v(0) = 0 satisfies the primal problem at s = 0, but M v + f = (0, 1) is not in H^T L: r = (a, -a, 1) leaves the
  // cone by 1/(2 a), which is 1/(2 a^2) of its length.
  const IncrementalProblem problem = example321();
  for (const double normal : {0.0, 1.0, 10.0, 1e3})
  {
    const Eigen::Vector3d r(normal, -normal, std::min(normal, 1.0));
    EXPECT_GT(validateAnswer(problem, Eigen::Vector2d::Zero(), r, Eigen::VectorXd(0)).worst(), 1e-7) << normal;
  }
}

TEST(SquareTest, OneVelocityASegmentOfImpulses)
{
  // Figure 1.13: v and H^T r are unique; (r_A, r_B) = (1/2, s, 1/2, -s) for all |s| <= 1/2.
  const IncrementalProblem square = squareOnTwoContacts();
  for (const double s : {-0.5, -0.2, 0.0, 0.5})
    EXPECT_LT(
        validateAnswer(square, Eigen::VectorXd::Zero(3), Eigen::Vector4d(0.5, s, 0.5, -s), Eigen::VectorXd(0)).worst(),
        1e-15);  // eps |r|/rho / S, the least that is ever reported
  EXPECT_GT(validateAnswer(square, Eigen::VectorXd::Zero(3), Eigen::Vector4d(0.5, 0.6, 0.5, -0.6), Eigen::VectorXd(0))
                .worst(),
            0.01);
  for (const double s : {0.0, 0.3, -0.45})
  {
    const Solution guess = guessOf(Eigen::Vector4d(0.45, s, 0.52, -s));
    forEverySolver(
        square, "square", allBut({}),
        [&](const SolverResult& result)
        {
          EXPECT_LT(result.solution.v.norm(), VELOCITY);
          EXPECT_LT((square.H.transpose() * result.solution.r - Eigen::Vector3d(0, 1, 0)).norm(), VELOCITY);
        },
        &guess);
  }
}

TEST(SquareTest, DifferentGuessesLeadToDifferentImpulses)
{
  const IncrementalProblem square = squareOnTwoContacts();
  const std::unique_ptr<Solver> portfolio = createSolver("portfolio");
  const Solution left = guessOf(Eigen::Vector4d(0.45, 0.3, 0.52, -0.3)),
                 right = guessOf(Eigen::Vector4d(0.45, -0.3, 0.52, 0.3));
  const SolverResult first = portfolio->solve(square, &left), second = portfolio->solve(square, &right);
  EXPECT_GT((first.solution.r - second.solution.r).norm(), 0.5);
  EXPECT_LT((first.solution.v - second.solution.v).norm(), VELOCITY);
}

TEST(SpringTest, TheMassHangsFreelyOrOnTheStop)
{
  // u = min(m g / k, h), lambda = max(0, m g - k h).
  const double stiffness = 100.0, height = 0.2;
  for (const double weight : {-5.0, 0.0, 10.0, 19.99, 20.0, 20.01, 35.0})
    forEverySolver(springAndStop(weight, stiffness, height), "spring under " + std::to_string(weight) + " N",
                   allBut({}),
                   [&](const SolverResult& result)
                   {
                     EXPECT_NEAR(result.solution.v[0], std::min(weight / stiffness, height), 1e-7);
                     EXPECT_NEAR(result.solution.r[0], std::max(0.0, weight - stiffness * height), 1e-5);
                   });
}

TEST(SubsetSumTest, EverySubsetThatSumsIsASolution)
{
  const std::vector<double> values = {3, 5, 7};
  for (int subset = 1; subset < 8; ++subset)
  {
    std::vector<bool> chosen;
    double total = 0.0;
    Eigen::VectorXd v = Eigen::VectorXd::Zero(6);
    for (int i = 0; i < 3; ++i)
    {
      chosen.push_back((subset >> i) % 2 == 1);
      const double value = values[static_cast<size_t>(i)];
      total += chosen.back() ? value : 0.0;
      v[i] = chosen.back() ? 0.0 : value;  // a bar slides and stands, or takes off
    }
    const IncrementalProblem machine = subsetSumMachine(values, total);
    const Eigen::VectorXd r = subsetSumImpulses(values, chosen);
    EXPECT_LT(validateAnswer(machine, v, r, Eigen::VectorXd(0)).worst(), 1e-14) << subset;  // as above, larger sums
    // One unit more on the base and the same impulses no longer balance it.
    EXPECT_GT(validateAnswer(subsetSumMachine(values, total + 1), v, r, Eigen::VectorXd(0)).worst(), 0.01);
    // Warm-started at the solution nobody leaves it.
    const Solution guess = guessOf(r);
    const SolverResult warm = createSolver("portfolio")->solve(machine, &guess);
    EXPECT_EQ(warm.status, SolverStatus::CONVERGED);
    EXPECT_EQ(warm.iterations, 0);
    // Cold, finding it is NP-complete (and any change of the data makes it infeasible, remark 1.5): no method must, but
    // what converges is this solution, or that of another subset with the same sum, which {3, 5, 7} does not have.
    forEverySolver(machine, "subset sum " + std::to_string(subset), {},
                   [&](const SolverResult& result) { EXPECT_LT((result.solution.v - v).norm(), 1e-4); });
  }
}

TEST(SubsetSumTest, WithoutASubsetNobodyFindsASolution)
{
  // Lemma 1.4: sums of {3, 5, 7} are 3, 5, 7, 8, 10, 12, 15.
  for (const double total : {1.0, 4.0, 9.0, 14.0})
    expectNoneConverges(subsetSumMachine({3, 5, 7}, total), "subset sum " + std::to_string(total));
}

TEST(SqueezedDiscTest, NobodyFindsASolutionWhereThereIsNone)
{
  // u_N of the two planes are v_y and -v_y - speed: not both >= 0.
  for (const double speed : {1e-3, 1.0})
    for (const double friction : {0.0, 0.5, 5.0})
      expectNoneConverges(squeezedDisc(speed, friction),
                          "disc squeezed at " + std::to_string(speed) + " m/s, mu " + std::to_string(friction));
}

TEST(SqueezedDiscTest, RetreatingPlanesAreNoObstacle)
{
  forEverySolver(squeezedDisc(-1.0, 0.5), "disc between retreating planes", allBut({}),
                 [](const SolverResult& result)
                 { EXPECT_LT((result.solution.v - Eigen::Vector3d(-0.2, 0, 0)).norm(), VELOCITY); });
}

TEST(ExampleD2Test, EveryMethodConvergesFromTheSingularStart)
{
  // df/dr = 0 there (asserted in solver_test and ds_newton_test); the square rests.
  const Solution start = guessOf(Eigen::Vector4d(6, 1, 8, 9));
  forEverySolver(
      squareOnTwoContacts(), "example D.2", allBut({}),
      [](const SolverResult& result) { EXPECT_LT(result.solution.v.norm(), VELOCITY); }, &start);
}
