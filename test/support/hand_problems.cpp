#include "support/hand_problems.h"

#include <array>

namespace frictional_contact_sim
{
namespace test_support
{
SparseRows sparse(const Eigen::MatrixXd& matrix)
{
  SparseRows result = matrix.sparseView();
  result.makeCompressed();
  return result;
}

DelassusProblem localProblem(const Eigen::MatrixXd& W, const Eigen::VectorXd& q, const std::vector<Law>& laws)
{
  DelassusProblem problem;
  problem.laws = laws;
  problem.W.assign(W, laws);
  problem.q = q;
  return problem;
}

IncrementalProblem restingBox(double mass, const Eigen::Vector3d& half_sizes, double friction,
                              const Eigen::Vector3d& velocity, const Eigen::Vector3d& gravity, double time_step)
{
  IncrementalProblem problem;
  const double a = half_sizes[0], b = half_sizes[1], c = half_sizes[2];
  Eigen::VectorXd inertia(6);
  inertia << mass, mass, mass, mass / 3 * (b * b + c * c), mass / 3 * (a * a + c * c), mass / 3 * (a * a + b * b);
  problem.M = sparse(Eigen::MatrixXd(inertia.asDiagonal()));
  problem.f.setZero(6);
  problem.f.head<3>() = -mass * (velocity + time_step * gravity);
  const std::array<Eigen::Vector3d, 4> corners = {Eigen::Vector3d(a, b, -c), Eigen::Vector3d(-a, b, -c),
                                                  Eigen::Vector3d(-a, -b, -c), Eigen::Vector3d(a, -b, -c)};
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(12, 6);
  for (int i = 0; i < 4; ++i)
  {
    const Eigen::Vector3d& x = corners[static_cast<size_t>(i)];
    Eigen::Matrix3d frame;  // rows: normal z, tangents x, y
    frame << 0, 0, 1, 1, 0, 0, 0, 1, 0;
    Eigen::Matrix3d cross;
    cross << 0, -x[2], x[1], x[2], 0, -x[0], -x[1], x[0], 0;
    H.block<3, 3>(3 * i, 0) = frame;
    H.block<3, 3>(3 * i, 3) = -frame * cross;  // velocity of the corner: v + omega x x
    problem.laws.push_back({LawType::COULOMB_3D, friction});
  }
  problem.H = sparse(H);
  problem.w.setZero(12);
  problem.G.resize(0, 6);
  problem.b.resize(0);
  return problem;
}

IncrementalProblem squareOnTwoContacts()
{
  IncrementalProblem problem;
  problem.M = sparse(Eigen::MatrixXd::Identity(3, 3));
  problem.f = Eigen::Vector3d(0, 1, 0);
  Eigen::MatrixXd H(4, 3);
  H << 0, 1, -1, 1, 0, 1, 0, 1, 1, 1, 0, 1;
  problem.H = sparse(H);
  problem.w.setZero(4);
  problem.laws.assign(2, {LawType::COULOMB_2D, 1.0});
  problem.G.resize(0, 3);
  problem.b.resize(0);
  return problem;
}

namespace
{
class Draw
{
public:
  explicit Draw(std::uint32_t seed) : engine_(seed) {}
  double normal() { return normal_(engine_); }
  double uniform(double low, double high) { return low + (high - low) * uniform_(engine_); }
  int integer(int count) { return static_cast<int>(engine_() % static_cast<std::uint32_t>(count)); }
  Eigen::MatrixXd matrix(int rows, int columns)
  {
    Eigen::MatrixXd result(rows, columns);
    for (int i = 0; i < rows; ++i)
      for (int j = 0; j < columns; ++j)
        result(i, j) = normal();
    return result;
  }

private:
  std::mt19937 engine_;
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> uniform_;
};
}  // namespace

IncrementalProblem randomProblem(const RandomProblemOptions& options, std::uint32_t seed)
{
  Draw draw(seed);
  const int size = 6 * options.bodies;
  IncrementalProblem problem;
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(size, size);
  for (int body = 0; body < options.bodies; ++body)
  {
    const Eigen::MatrixXd A = draw.matrix(6, 6);
    M.block(6 * body, 6 * body, 6, 6) = A * A.transpose() + 0.5 * Eigen::MatrixXd::Identity(6, 6);
  }
  problem.M = sparse(M);
  problem.f = draw.matrix(size, 1);
  for (int i = 0; i < options.contacts; ++i)
    problem.laws.push_back({LawType::COULOMB_3D, draw.uniform(0.2, 0.8)});
  for (int i = 0; i < options.planar_contacts; ++i)
    problem.laws.push_back({LawType::COULOMB_2D, draw.uniform(0.2, 0.8)});
  for (int i = 0; i < options.unilateral; ++i)
    problem.laws.push_back({LawType::UNILATERAL, 0.0});
  for (int i = 0; i < options.dry; ++i)
    problem.laws.push_back({LawType::DRY_FRICTION, draw.uniform(0.1, 1.0)});
  const int rows = rowCount(problem.laws);
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(rows, size);
  int row = 0;
  for (const Law& law : problem.laws)
  {
    const int first = draw.integer(options.bodies);
    const int second = draw.integer(options.bodies);
    H.block(row, 6 * first, law.dimension(), 6) = draw.matrix(law.dimension(), 6);
    if (second != first)
      H.block(row, 6 * second, law.dimension(), 6) = draw.matrix(law.dimension(), 6);
    row += law.dimension();
  }
  problem.H = sparse(H);
  problem.w.setZero(rows);
  if (options.moving_externals)
    problem.w = H * Eigen::VectorXd(draw.matrix(size, 1));
  const Eigen::MatrixXd G = draw.matrix(options.bilaterals, size);
  problem.G = sparse(G);
  problem.b.setZero(options.bilaterals);
  return problem;
}

}  // namespace test_support
}  // namespace frictional_contact_sim
