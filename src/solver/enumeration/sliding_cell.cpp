#include "sliding_cell.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace frictional_contact_sim
{
namespace
{
constexpr double PI = 3.14159265358979323846;
constexpr int NEWTON_STEPS = 30;
constexpr double ZERO = 1e-12;  ///< |F| at a zero, relative to the impulses' size
constexpr double TOLERANCE = 1e-8;  ///< inequalities of a solution
constexpr double ROUND_OFF = 1e-13;  ///< of impulses, relative
constexpr double RANK = 1e-9;
constexpr double WIDEST = 1.0;  ///< [rad], no proof is tried for more

using Indices = std::vector<Eigen::Index>;

Eigen::Vector2d direction(double angle)
{
  return {std::cos(angle), std::sin(angle)};
}

class WedgeEquations
{
public:
  WedgeEquations(const ScaledIsland& island, const Relaxation& relaxation, const Cell& cell)
    : island_(island), relaxation_(relaxation), cell_(cell)
  {
    fixed_ = Eigen::VectorXd::Zero(island.rows());
    for (size_t i = 0; i < island.laws.size(); ++i)
    {
      if (cell.modes[i] == LawMode::SLIDE)
      {
        slides_.push_back(i);
        continue;
      }
      for (int k = 0; k < island.laws[i].dimension(); ++k)
      {
        const Eigen::Index index = island.offsets[i] + k;
        if (relaxation.columnLower()[index] < relaxation.columnUpper()[index])
          columns_.push_back(index);
        else
          fixed_[index] = relaxation.columnLower()[index];
        if (relaxation.rowLower()[index] == relaxation.rowUpper()[index])
          rows_.push_back(index);
      }
    }
    fixed_ = relaxation.impulses(fixed_);
  }

  bool isSquare() const { return rows_.size() == columns_.size() && island_.e.size() == 0; }
  Eigen::Index linear() const { return static_cast<Eigen::Index>(columns_.size()); }
  Eigen::Index slides() const { return static_cast<Eigen::Index>(slides_.size()); }
  Eigen::Index size() const { return linear() + 3 * slides(); }

  /// From the linear program's point.
  Eigen::VectorXd start() const
  {
    Eigen::VectorXd x(size());
    for (Eigen::Index j = 0; j < linear(); ++j)
      x[j] = relaxation_.point()[columns_[static_cast<size_t>(j)]];
    const Eigen::VectorXd u = island_.W * relaxation_.impulses(relaxation_.point()) + island_.q;
    for (Eigen::Index k = 0; k < slides(); ++k)
    {
      const size_t law = slides_[static_cast<size_t>(k)];
      const double angle = cell_.centers[law];
      x.segment<3>(place(k)) << relaxation_.point()[island_.offsets[law]],
          u.segment<2>(island_.offsets[law] + 1).dot(direction(angle)), angle;
    }
    return x;
  }

  Eigen::VectorXd impulses(const Eigen::VectorXd& x) const
  {
    Eigen::VectorXd r = fixed_;
    for (Eigen::Index j = 0; j < linear(); ++j)
      r += x[j] * relaxation_.generators().col(columns_[static_cast<size_t>(j)]);
    for (Eigen::Index k = 0; k < slides(); ++k)
    {
      r[row(k)] = x[place(k)];
      r.segment<2>(row(k) + 1) = -friction(k) * x[place(k)] * direction(x[place(k) + 2]);
    }
    return r;
  }

  Eigen::VectorXd value(const Eigen::VectorXd& x) const
  {
    const Eigen::VectorXd u = island_.W * impulses(x) + island_.q;
    Eigen::VectorXd F(size());
    for (Eigen::Index j = 0; j < linear(); ++j)
      F[j] = u[rows_[static_cast<size_t>(j)]];
    for (Eigen::Index k = 0; k < slides(); ++k)
    {
      F.segment<3>(place(k)) = u.segment<3>(row(k));
      F.segment<2>(place(k) + 1) -= x[place(k) + 1] * direction(x[place(k) + 2]);
    }
    return F;
  }

  Eigen::MatrixXd jacobian(const Eigen::VectorXd& x) const
  {
    Eigen::MatrixXd by_x(island_.rows(), size());  // dr/dx
    by_x.setZero();
    for (Eigen::Index j = 0; j < linear(); ++j)
      by_x.col(j) = relaxation_.generators().col(columns_[static_cast<size_t>(j)]);
    for (Eigen::Index k = 0; k < slides(); ++k)
    {
      const double mu = friction(k), angle = x[place(k) + 2];
      by_x(row(k), place(k)) = 1.0;
      by_x.block<2, 1>(row(k) + 1, place(k)) = -mu * direction(angle);
      by_x.block<2, 1>(row(k) + 1, place(k) + 2) = -mu * x[place(k)] * direction(angle + 0.5 * PI);
    }
    const Eigen::MatrixXd u = island_.W * by_x;
    Eigen::MatrixXd J(size(), size());
    for (Eigen::Index j = 0; j < linear(); ++j)
      J.row(j) = u.row(rows_[static_cast<size_t>(j)]);
    for (Eigen::Index k = 0; k < slides(); ++k)
    {
      const double angle = x[place(k) + 2];
      J.middleRows<3>(place(k)) = u.middleRows<3>(row(k));
      J.block<2, 1>(place(k) + 1, place(k) + 1) -= direction(angle);
      J.block<2, 1>(place(k) + 1, place(k) + 2) -= x[place(k) + 1] * direction(angle + 0.5 * PI);
    }
    return J;
  }

  /** Newton with least-norm steps; damped where the residual grows. @return a zero was found */
  bool solve(Eigen::VectorXd& x) const
  {
    Eigen::VectorXd F = value(x);
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factor;
    factor.setThreshold(RANK);
    for (int step = 0; step < NEWTON_STEPS && !isZero(F, x); ++step)
    {
      factor.compute(jacobian(x));
      const Eigen::VectorXd change = factor.solve(F);
      double length = 1.0;
      Eigen::VectorXd next = x - change;
      for (; length > 1e-3 && !(value(next).norm() < (1.0 - 0.1 * length) * F.norm()); length *= 0.5)
        next = x - 0.5 * length * change;
      x = next;
      F = value(x);
      if (!x.allFinite())
        return false;
    }
    for (Eigen::Index k = 0; k < slides(); ++k)
    {
      double& angle = x[place(k) + 2];
      const double center = cell_.centers[slides_[static_cast<size_t>(k)]];
      angle = center + std::remainder(angle - center, 2.0 * PI);
    }
    return isZero(F, x);
  }

  double distance(const Eigen::VectorXd& x, Eigen::Index k) const
  {
    return std::abs(x[place(k) + 2] - cell_.centers[slides_[static_cast<size_t>(k)]]);
  }
  double half(Eigen::Index k) const { return cell_.halves[slides_[static_cast<size_t>(k)]]; }

  /// x is a solution, its slips inside the wedges widened by `margin` times their half width.
  bool holds(const Eigen::VectorXd& x, double margin) const
  {
    const double allowed = TOLERANCE + ROUND_OFF * impulses(x).lpNorm<Eigen::Infinity>();
    for (Eigen::Index k = 0; k < slides(); ++k)
      if (x[place(k)] < -allowed || x[place(k) + 1] < -allowed || distance(x, k) > (1.0 + margin) * half(k) + TOLERANCE)
        return false;
    const Eigen::VectorXd r = impulses(x), u = island_.W * r + island_.q;
    for (Eigen::Index j = 0; j < linear(); ++j)
    {
      const Eigen::Index column = columns_[static_cast<size_t>(j)];
      if (x[j] < relaxation_.columnLower()[column] - allowed || x[j] > relaxation_.columnUpper()[column] + allowed)
        return false;
    }
    for (size_t i = 0; i < cell_.modes.size(); ++i)
    {
      const int first = island_.offsets[i], dimension = island_.laws[i].dimension();
      if (cell_.modes[i] == LawMode::SLIDE)
        continue;
      if (relaxation_.isSpatial(static_cast<int>(i)) &&
          r.segment<2>(first + 1).norm() > island_.laws[i].coefficient * r[first] + allowed)
        return false;
      for (int index = first; index < first + dimension; ++index)
      {
        const double activity = u[index] - island_.q[index];
        if (activity < relaxation_.rowLower()[index] - allowed || activity > relaxation_.rowUpper()[index] + allowed)
          return false;
      }
    }
    return true;
  }

  /// F is injective on a box that holds x and every zero with slips in the wedges.
  bool isInjective(const Eigen::VectorXd& x) const
  {
    Eigen::VectorXd turn(slides());
    for (Eigen::Index k = 0; k < slides(); ++k)
      turn[k] = distance(x, k) + half(k);
    if (turn.maxCoeff() > WIDEST)
      return false;
    const Eigen::MatrixXd J = jacobian(x);
    const Eigen::VectorXd reach = linearReach(x, J, turn);
    if (reach.size() == 0)
      return false;
    const Eigen::PartialPivLU<Eigen::MatrixXd> factor(J);
    const Eigen::MatrixXd inverse = factor.inverse();
    if (!inverse.allFinite())
      return false;
    const Eigen::MatrixXd D = variation(x, turn, reach);
    return (inverse.cwiseAbs() * D).rowwise().sum().maxCoeff() < 1.0 - 1e-6;
  }

private:
  Eigen::Index place(Eigen::Index k) const { return linear() + 3 * k; }
  Eigen::Index row(Eigen::Index k) const { return island_.offsets[slides_[static_cast<size_t>(k)]]; }
  double friction(Eigen::Index k) const { return island_.laws[slides_[static_cast<size_t>(k)]].coefficient; }
  bool isZero(const Eigen::VectorXd& F, const Eigen::VectorXd& x) const
  {
    return F.lpNorm<Eigen::Infinity>() <= ZERO * std::max(1.0, x.lpNorm<Eigen::Infinity>());
  }
  /// |W| of the tangential columns of a sliding contact, summed: what a unit change of each does to u.
  Eigen::VectorXd tangentialReach(Eigen::Index k) const
  {
    return island_.W.middleCols<2>(row(k) + 1).cwiseAbs().rowwise().sum();
  }

  /**
   * How far z, r_N and s of any zero with slips within `turn` of x can be from those of x: one number for (z, r_N), one
   * an s. Empty when the linear system is too close to singular.
   */
  Eigen::VectorXd linearReach(const Eigen::VectorXd& x, const Eigen::MatrixXd& J, const Eigen::VectorXd& turn) const
  {
    const Eigen::Index count = linear() + slides();
    Indices kept;
    for (Eigen::Index j = 0; j < linear(); ++j)
      kept.push_back(j);
    for (Eigen::Index k = 0; k < slides(); ++k)
      kept.push_back(place(k));
    Eigen::MatrixXd A(count, count), change = Eigen::MatrixXd::Zero(count, count);
    Eigen::VectorXd z(count);
    for (Eigen::Index j = 0; j < count; ++j)
    {
      z[j] = x[kept[static_cast<size_t>(j)]];
      for (Eigen::Index i = 0; i < count; ++i)
        A(i, j) = J(kept[static_cast<size_t>(i)], kept[static_cast<size_t>(j)]);
    }
    for (Eigen::Index k = 0; k < slides(); ++k)
    {
      const Eigen::VectorXd reach = friction(k) * turn[k] * tangentialReach(k);
      for (Eigen::Index i = 0; i < count; ++i)
        change(i, linear() + k) = reach[i < linear() ? rows_[static_cast<size_t>(i)] : row(i - linear())];
    }
    const Eigen::MatrixXd inverse = Eigen::PartialPivLU<Eigen::MatrixXd>(A).inverse();
    const double kappa = (inverse.cwiseAbs() * change).rowwise().sum().maxCoeff();
    if (!(kappa < 0.5))
      return {};
    Eigen::VectorXd reach(1 + slides());
    reach[0] = kappa / (1.0 - kappa) * z.lpNorm<Eigen::Infinity>();
    // s = d.u_T, and u changes with r.
    Eigen::VectorXd impulse_change = Eigen::VectorXd::Zero(island_.rows());
    for (const Eigen::Index column : columns_)
      impulse_change += reach[0] * relaxation_.generators().col(column).cwiseAbs();
    for (Eigen::Index k = 0; k < slides(); ++k)
    {
      impulse_change[row(k)] = reach[0];
      impulse_change.segment<2>(row(k) + 1).setConstant(friction(k) * (reach[0] + std::abs(x[place(k)]) * turn[k]));
    }
    const Eigen::VectorXd velocity_change = island_.W.cwiseAbs() * impulse_change;
    for (Eigen::Index k = 0; k < slides(); ++k)
      reach[1 + k] = turn[k] * std::abs(x[place(k) + 1]) + velocity_change.segment<2>(row(k) + 1).sum();
    return reach;
  }

  /// Bounds of |F'(x') - F'(x)| entry by entry.
  Eigen::MatrixXd variation(const Eigen::VectorXd& x, const Eigen::VectorXd& turn, const Eigen::VectorXd& reach) const
  {
    Eigen::MatrixXd D = Eigen::MatrixXd::Zero(size(), size());
    for (Eigen::Index k = 0; k < slides(); ++k)
    {
      const Eigen::VectorXd tangential = friction(k) * tangentialReach(k);
      const double by_angle = reach[0] + std::abs(x[place(k)]) * turn[k];
      for (Eigen::Index i = 0; i < size(); ++i)
      {
        const Eigen::Index at =
            i < linear() ? rows_[static_cast<size_t>(i)] : row((i - linear()) / 3) + (i - linear()) % 3;
        D(i, place(k)) = tangential[at] * turn[k];
        D(i, place(k) + 2) = tangential[at] * by_angle;
      }
      for (Eigen::Index i = place(k) + 1; i < place(k) + 3; ++i)
      {
        D(i, place(k) + 1) += turn[k];
        D(i, place(k) + 2) += reach[1 + k] + std::abs(x[place(k) + 1]) * turn[k];
      }
    }
    return D;
  }

  const ScaledIsland& island_;
  const Relaxation& relaxation_;
  const Cell& cell_;
  std::vector<size_t> slides_;
  Indices columns_, rows_;
  Eigen::VectorXd fixed_;  ///< r of the fixed columns
};
}  // namespace

WedgeContent resolveWedges(const ScaledIsland& island, const Relaxation& relaxation, const Cell& cell,
                           std::optional<Leaf>& leaf)
{
  leaf.reset();
  const WedgeEquations equations(island, relaxation, cell);
  if (!equations.isSquare())
    return WedgeContent::UNKNOWN;
  Eigen::VectorXd x = equations.start();
  if (!equations.solve(x))
    return WedgeContent::UNKNOWN;
  const bool injective = equations.isInjective(x);
  if (equations.holds(x, injective ? 0.0 : 1.0))
  {
    leaf.emplace();
    leaf->cell = cell;
    leaf->proved = injective;
    leaf->piece.modes = cell.modes;
    leaf->piece.vertices = {equations.impulses(x)};
    if (!injective)
    {
      Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factor;
      factor.setThreshold(RANK);
      factor.compute(equations.jacobian(x));
      leaf->piece.dimension = static_cast<int>(equations.size() - factor.rank());
      leaf->piece.vertices_complete = leaf->piece.dimension == 0;
      leaf->piece.unique_velocity = leaf->piece.dimension == 0;  // of more is known at one point only
    }
  }
  return !injective ? WedgeContent::UNKNOWN : leaf ? WedgeContent::ONE : WedgeContent::NONE;
}

}  // namespace frictional_contact_sim
