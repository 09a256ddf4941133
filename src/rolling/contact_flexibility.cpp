#include "frictional_contact_sim/rolling/contact_flexibility.h"

#include <Eigen/LU>
#include <cmath>
#include <stdexcept>

namespace frictional_contact_sim
{
namespace
{
constexpr double PI = 3.14159265358979323846;

/// int_0^s ln|x/D| dx
double logIntegral(double s, double datum)
{
  return s == 0.0 ? 0.0 : s * (std::log(std::abs(s) / datum) - 1.0);
}

/// Degrees of freedom 2 i, 2 i + 1 of the elements.
std::vector<Eigen::Index> components(const std::vector<Eigen::Index>& elements)
{
  std::vector<Eigen::Index> rows;
  for (Eigen::Index element : elements)
  {
    rows.push_back(2 * element);
    rows.push_back(2 * element + 1);
  }
  return rows;
}

Eigen::MatrixXd pick(const Eigen::MatrixXd& matrix, const std::vector<Eigen::Index>& rows,
                     const std::vector<Eigen::Index>& columns)
{
  Eigen::MatrixXd part(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(columns.size()));
  for (size_t j = 0; j < columns.size(); ++j)
    for (size_t i = 0; i < rows.size(); ++i)
      part(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = matrix(rows[i], columns[j]);
  return part;
}

/// C' of (19) with columns e_N, e_T for each contact element, all normals before all tangents: 2n x 2n.
Eigen::MatrixXd frameMatrix(const Contour& contour, const std::vector<Eigen::Index>& contact, ContactFrames frames)
{
  const auto n = static_cast<Eigen::Index>(contact.size());
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  for (Eigen::Index i = 0; i < n; ++i)
  {
    const bool flat = frames == ContactFrames::FLAT;
    const Eigen::Vector2d tangent = flat ? Eigen::Vector2d(1.0, 0.0) : contour.tangent(contact[static_cast<size_t>(i)]);
    C.block<2, 1>(2 * i, i) << -tangent.y(), tangent.x();
    C.block<2, 1>(2 * i, n + i) = tangent;
  }
  return C;
}
}  // namespace

Eigen::MatrixXd ContactFlexibility::full() const
{
  Eigen::MatrixXd F(2 * size(), 2 * size());
  F << NN, NT, TN, TT;
  return F;
}

double ContactFlexibility::asymmetry() const
{
  Eigen::VectorXd force_to_traction(2 * size());
  force_to_traction << width.cwiseInverse(), width.cwiseInverse();
  const Eigen::MatrixXd A = full() * force_to_traction.asDiagonal();
  return (A - A.transpose()).norm() / A.norm();
}

void makeUniformNodes(double half_width, int count, Eigen::VectorXd& x, Eigen::VectorXd& width)
{
  if (count < 1 || !(half_width > 0.0))
    throw std::invalid_argument("found " + std::to_string(count) + " contact nodes on a half-width of " +
                                std::to_string(half_width) + ", expected at least one on a positive one");
  const double h = 2.0 * half_width / count;
  width = Eigen::VectorXd::Constant(count, h);
  x.resize(count);
  for (int i = 0; i < count; ++i)
    x[i] = (i + 0.5 - 0.5 * count) * h;
}

ContactFlexibility halfPlaneFlexibility(const PlaneStrainMaterial& material, const Eigen::VectorXd& x,
                                        const Eigen::VectorXd& width, double datum)
{
  material.validate();
  const Eigen::Index n = x.size();
  if (n == 0 || width.size() != n || !(width.minCoeff() > 0.0) || !(datum > 0.0))
    throw std::invalid_argument("half-plane: found " + std::to_string(n) + " contact nodes and a datum of " +
                                std::to_string(datum) + ", expected nodes of positive width and a positive datum");
  ContactFlexibility F;
  F.x = x;
  F.width = width;
  F.NN.resize(n, n);
  F.NT.resize(n, n);
  const double direct = 2.0 * material.compliance() / PI;
  const double coupling = 0.5 * material.couplingCompliance();
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::Index i = 0; i < n; ++i)
    {
      const double left = x[i] - x[j] + 0.5 * width[j], right = x[i] - x[j] - 0.5 * width[j];
      F.NN(i, j) = -direct * (logIntegral(left, datum) - logIntegral(right, datum));
      F.NT(i, j) = coupling * (std::abs(left) - std::abs(right));
    }
  F.TT = F.NN;
  F.TN = -F.NT;
  return F;
}

ContactFlexibility halfPlaneFlexibility(const MaterialPair& materials, const Eigen::VectorXd& x,
                                        const Eigen::VectorXd& width, double datum)
{
  ContactFlexibility F = halfPlaneFlexibility(materials.upper, x, width, datum);
  if (!materials.lower_is_rigid)
    addLowerHalfPlane(materials.lower, datum, F);
  return F;
}

ContactFlexibility condense(const Contour& contour, const PlaneStrainMaterial& material, ContactFrames frames)
{
  const std::vector<Eigen::Index> contact = contour.select(ElementKind::CONTACT);
  const std::vector<Eigen::Index> held = contour.select(ElementKind::HELD);
  if (contact.empty())
    throw std::invalid_argument("found no contact nodes, expected at least one element of kind contact");
  if (held.empty())
    throw std::invalid_argument("found no held elements, expected at least one (H_ff is singular for a free body)");
  const BoundaryMatrices matrices = assembleBoundaryMatrices(contour, material);
  // (14): the columns of held elements belong to their unknown tractions.
  Eigen::MatrixXd A = matrices.H;
  const double unit = A.norm() / matrices.G.norm();
  for (Eigen::Index k : components(held))
    A.col(k) = -unit * matrices.G.col(k);
  std::vector<Eigen::Index> others = contour.select(ElementKind::FREE);
  others.insert(others.end(), held.begin(), held.end());
  const std::vector<Eigen::Index> c = components(contact), f = components(others);

  const Eigen::MatrixXd C = frameMatrix(contour, contact, frames);
  const Eigen::MatrixXd H_cf = pick(A, c, f);
  const Eigen::PartialPivLU<Eigen::MatrixXd> H_ff(pick(A, f, f));
  const Eigen::MatrixXd condensed_H = (pick(A, c, c) - H_cf * H_ff.solve(pick(A, f, c))) * C;
  const Eigen::MatrixXd condensed_G = (pick(matrices.G, c, c) - H_cf * H_ff.solve(pick(matrices.G, f, c))) * C;  // (22)
  const Eigen::MatrixXd flexibility = condensed_H.partialPivLu().solve(condensed_G);  // (23)

  const auto n = static_cast<Eigen::Index>(contact.size());
  ContactFlexibility F;
  F.x.resize(n);
  F.width.resize(n);
  for (Eigen::Index i = 0; i < n; ++i)
  {
    F.x[i] = contour.middle(contact[static_cast<size_t>(i)]).x();
    F.width[i] = contour.length(contact[static_cast<size_t>(i)]);
  }
  F.NN = flexibility.topLeftCorner(n, n);
  F.NT = flexibility.topRightCorner(n, n);
  F.TN = flexibility.bottomLeftCorner(n, n);
  F.TT = flexibility.bottomRightCorner(n, n);
  return F;
}

void addLowerHalfPlane(const PlaneStrainMaterial& material, double datum, ContactFlexibility& flexibility)
{
  // Seen upside down its normal displacement and traction change sign together, the tangential ones likewise keep
  // theirs: only the coupling turns round.
  const ContactFlexibility lower = halfPlaneFlexibility(material, flexibility.x, flexibility.width, datum);
  flexibility.NN += lower.NN;
  flexibility.TT += lower.TT;
  flexibility.NT -= lower.NT;
  flexibility.TN -= lower.TN;
}

}  // namespace frictional_contact_sim
