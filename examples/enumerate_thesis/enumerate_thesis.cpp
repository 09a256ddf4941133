// The complete search as a library, on two problems of Cadoux (2009), section 1.4:
//   enumerate_thesis rod [STEPS]       Painleve's rod over a grid, as CSV for scripts/plot_rod
//   enumerate_thesis subset_sum K...   machines with K bars: solutions, nodes, seconds
//   enumerate_thesis cuts K...         the same machines, and random planar problems of K contacts, with and without
//   cuts
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <random>
#include <string>

#include "frictional_contact_sim/solver/enumeration/enumeration.h"

namespace fcs = frictional_contact_sim;

namespace
{
constexpr double FRICTION_MAX = 3.0;

fcs::SparseRows sparse(const Eigen::MatrixXd& matrix)
{
  return matrix.sparseView();
}

/** One velocity, one planar contact, (1.38) with nu = 2, l = 1, h = 2/3, v_0 = 0; gravity +1 upwards. */
fcs::IncrementalProblem rod(double angle, double friction, double gravity, double support)
{
  fcs::IncrementalProblem problem;
  problem.M = sparse(Eigen::MatrixXd::Identity(1, 1));
  problem.f = Eigen::VectorXd::Constant(1, -gravity * std::sin(angle));
  problem.H = sparse(Eigen::Vector2d(std::sin(angle), std::cos(angle)));
  problem.w = Eigen::Vector2d(0.0, support);
  problem.laws = {{fcs::LawType::COULOMB_2D, friction}};
  problem.G.resize(0, 1);
  problem.b.resize(0);
  return problem;
}

/** (1.48)-(1.50) with the signs of (1.49) put right: velocities of the bars, of the two at the ends, of the base. */
fcs::IncrementalProblem machine(const std::vector<int>& values, int total)
{
  const auto k = static_cast<Eigen::Index>(values.size());
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(2 * k + 4, k + 3);
  fcs::IncrementalProblem problem;
  problem.f.setZero(k + 3);
  problem.w.setZero(2 * k + 4);
  for (Eigen::Index i = 0; i < k + 2; ++i)
  {
    H(2 * i, i) = H(2 * i + 1, i) = 1.0;
    H(i < k ? 2 * i + 1 : 2 * i, k + 2) = i == k ? 1.0 : -1.0;
    problem.w[2 * i + 1] = 1.0;
    if (i < k)
      problem.f[i] = -values[static_cast<size_t>(i)];
  }
  problem.f[k + 2] = 2.0 * total;
  problem.M = sparse(Eigen::MatrixXd::Identity(k + 3, k + 3));
  problem.H = sparse(H);
  problem.laws.assign(static_cast<size_t>(k) + 2, {fcs::LawType::COULOMB_2D, 2.0});
  problem.G.resize(0, k + 3);
  problem.b.resize(0);
  return problem;
}

void printRods(int steps)
{
  std::printf("gravity,support,angle,friction,complete,solutions,continua\n");
  for (const double gravity : {1.0, -1.0})
    for (const double support : {1.0, 0.0, -1.0})
      for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j)
        {
          const double angle = (i + 0.5) / steps * 0.5 * M_PI, friction = (j + 0.5) / steps * FRICTION_MAX;
          const fcs::EnumerationReport report = fcs::enumerate(rod(angle, friction, gravity, support));
          std::printf("%g,%g,%.9g,%.9g,%d,%d,%d\n", gravity, support, angle, friction, report.complete ? 1 : 0,
                      report.solutions, report.continua);
        }
}

struct Bars
{
  std::vector<int> values;
  int half = 0, all = 0;
};

/** Values of 1 to 50, the sum of a random half of them, and that of all. */
Bars drawBars(int count)
{
  std::mt19937 engine(static_cast<unsigned>(count));
  Bars bars;
  for (int i = 0; i < count; ++i)
  {
    bars.values.push_back(1 + static_cast<int>(engine() % 50));
    bars.half += engine() % 2 == 0 ? bars.values.back() : 0;
    bars.all += bars.values.back();
  }
  return bars;
}

/** A total that subsets have; and one more than all together, which none has. */
void printMachine(int bars)
{
  const auto [values, half, all] = drawBars(bars);
  std::vector<long> subsets(static_cast<size_t>(all) + 1, 0);
  subsets[0] = 1;
  for (const int value : values)
    for (int sum = all; sum >= value; --sum)
      subsets[static_cast<size_t>(sum)] += subsets[static_cast<size_t>(sum - value)];
  fcs::EnumerateOptions options;
  options.max_nodes = 10000000;
  for (const int total : {half, all + 1})
  {
    const long expected = total > all ? 0 : subsets[static_cast<size_t>(total)];
    const fcs::EnumerationReport report = fcs::enumerate(machine(values, total), options);
    std::printf("%2d bars, sum %4d: %ld subsets, %d solutions, %s, %ld nodes, %.3g s\n", bars, total, expected,
                report.solutions, report.complete ? "complete" : "not complete", report.nodes, report.seconds);
    std::fflush(stdout);
  }
}
/** W = Z Z', half of full rank, numbers from -1 to 1. */
fcs::DelassusProblem randomPlanar(int contacts, unsigned seed)
{
  std::mt19937 engine(seed);
  const auto draw = [&engine] { return 2.0 * (engine() / 4294967296.0) - 1.0; };
  Eigen::MatrixXd Z(2 * contacts, contacts);
  fcs::DelassusProblem problem;
  problem.q.resize(2 * contacts);
  for (Eigen::Index i = 0; i < Z.rows(); ++i)
  {
    for (Eigen::Index j = 0; j < Z.cols(); ++j)
      Z(i, j) = draw();
    problem.q[i] = draw();
  }
  problem.laws.assign(static_cast<size_t>(contacts), {fcs::LawType::COULOMB_2D, 0.7});
  problem.W.assign(Z * Z.transpose(), problem.laws);
  return problem;
}

struct Policy
{
  const char* name;
  fcs::EnumerationCuts cuts;
  int depth, rounds;
};
constexpr Policy POLICIES[] = {{"none", fcs::EnumerationCuts::NONE, 0, 1},
                               {"most violated, root, 20 rounds", fcs::EnumerationCuts::MOST_VIOLATED, 0, 20},
                               {"deepest, root, 20 rounds", fcs::EnumerationCuts::DEEPEST, 0, 20},
                               {"facets, root, 20 rounds", fcs::EnumerationCuts::FACETS, 0, 20},
                               {"most violated, 3 laws deep", fcs::EnumerationCuts::MOST_VIOLATED, 3, 5},
                               {"most violated, everywhere", fcs::EnumerationCuts::MOST_VIOLATED, 1000, 2},
                               {"facets, everywhere", fcs::EnumerationCuts::FACETS, 1000, 2}};

constexpr double TIME_LIMIT = 200.0;  ///< of one search [s]
constexpr int CONTACTS_MOST = 10;  ///< of the random problems

/** One line a policy, over some problems together. */
template <typename Problem>
void printCuts(const char* what, const std::vector<Problem>& problems)
{
  for (const Policy& policy : POLICIES)
  {
    fcs::EnumerateOptions options;
    options.cuts = policy.cuts;
    options.cut_depth = policy.depth;
    options.cuts_per_node = policy.rounds;
    options.max_nodes = 100000000;
    options.time_limit = TIME_LIMIT;
    long nodes = 0, cuts = 0, solutions = 0;
    bool complete = true;
    const std::clock_t start = std::clock();
    for (const Problem& problem : problems)
    {
      const fcs::EnumerationReport report = fcs::enumerate(problem, options);
      nodes += report.nodes;
      cuts += report.cuts;
      solutions += report.solutions;
      complete = complete && report.complete;
    }
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    std::printf("| %s | %s | %ld%s | %ld | %ld | %.3g |\n", what, policy.name, solutions,
                complete ? "" : ", not complete", nodes, cuts, seconds);
    std::fflush(stdout);
  }
}

void printWithCuts(int size)
{
  const Bars bars = drawBars(size);
  const std::string name = std::to_string(size);
  printCuts((name + " bars, half").c_str(), std::vector<fcs::IncrementalProblem>{machine(bars.values, bars.half)});
  printCuts((name + " bars, none").c_str(), std::vector<fcs::IncrementalProblem>{machine(bars.values, bars.all + 1)});
  std::vector<fcs::DelassusProblem> problems;
  for (unsigned seed = 0; seed < 10; ++seed)
    problems.push_back(randomPlanar(size, seed));
  if (size <= CONTACTS_MOST)
    printCuts((name + " contacts, 10 draws").c_str(), problems);
}
}  // namespace

int main(int argc, char** argv)
{
  const std::string what = argc > 1 ? argv[1] : "";
  if ((what != "rod" && what != "subset_sum" && what != "cuts") || (what != "rod" && argc < 3))
  {
    std::fprintf(stderr, "usage: enumerate_thesis rod [STEPS] | subset_sum K... | cuts K...\n");
    return 2;
  }
  try
  {
    if (what == "rod")
      printRods(argc > 2 ? std::stoi(argv[2]) : 40);
    else
      for (int i = 2; i < argc; ++i)
        what == "cuts" ? printWithCuts(std::stoi(argv[i])) : printMachine(std::stoi(argv[i]));
  }
  catch (const std::exception& error)
  {
    std::fprintf(stderr, "enumerate_thesis: %s\n", error.what());
    return 2;
  }
  return 0;
}
