#include "contact_kinematics.h"

namespace frictional_contact_sim
{
namespace
{
void copyRow(const SparseRows& matrix, int row, int target, std::vector<Eigen::Triplet<double>>& entries)
{
  for (SparseRows::InnerIterator entry(matrix, row); entry; ++entry)
    entries.emplace_back(target, static_cast<int>(entry.col()), entry.value());
}
}  // namespace

ContactKinematics collectKinematics(const SparseRows& H, const Eigen::VectorXd& w, const std::vector<Law>& laws,
                                    const SparseRows* G, const Eigen::VectorXd* b)
{
  ContactKinematics kinematics;
  kinematics.H = H;
  kinematics.w = w;
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<double> offsets;
  int row = 0;
  for (size_t i = 0; i < laws.size(); ++i)
  {
    const Law& law = laws[i];
    if (law.isOneSided())
      kinematics.cones.push_back({static_cast<int>(i), row, law.dimension(), law.isCoulomb() ? law.coefficient : 0.0});
    else if (law.type == LawType::BILATERAL)
    {
      copyRow(H, row, static_cast<int>(offsets.size()), entries);
      offsets.push_back(w[row]);
      kinematics.bilateral_law.push_back(static_cast<int>(i));
      kinematics.bilateral_row.push_back(-1);
    }
    row += law.dimension();
  }
  for (int j = 0; G != nullptr && j < G->rows(); ++j)
  {
    copyRow(*G, j, static_cast<int>(offsets.size()), entries);
    offsets.push_back((*b)[j]);
    kinematics.bilateral_law.push_back(-1);
    kinematics.bilateral_row.push_back(j);
  }
  const auto count = static_cast<Eigen::Index>(offsets.size());
  kinematics.E.resize(count, H.cols());
  kinematics.E.setFromTriplets(entries.begin(), entries.end());
  kinematics.b = Eigen::Map<const Eigen::VectorXd>(offsets.data(), count);
  return kinematics;
}

}  // namespace frictional_contact_sim
