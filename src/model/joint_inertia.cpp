#include "joint_inertia.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <sstream>

#include "frictional_contact_sim/model/dynamics_algorithms.h"
#include "frictional_contact_sim/model/urdf_loader.h"

namespace frictional_contact_sim
{
namespace
{
/// Least pivot over diagonal entry that counts as positive; round-off of their difference is some 1e-15, and chains
/// with true ratios below 1e-8 are not known.
constexpr double LEAST_PIVOT_RATIO = 1e-10;
constexpr double ROUND_OFF = 1e-12;  ///< of a link's inertia about an axis, relative to its largest
constexpr double LEAST_SHARE = 1e-9;  ///< of what a joint carries: less drowns in round-off
constexpr double UNFELT_SHARE = 1e-7;  ///< of what a joint carries, or its leader moves: nobody notices
constexpr double BODY_SHARE = 1e-6;  ///< of the body: the default

/** Coordinates of one joint that are given the same: those along which, or those about which its links move. */
struct Part
{
  int joint = 0;
  int first = 0;  ///< in v
  int size = 0;
  bool slides = false;
  double load = 0.0;  ///< what it carries, before anything is added [kg] or [kg m^2]
  bool is_given = false;  ///< min_joint_inertia
  double added = 0.0;  ///< [kg] or [kg m^2]
};

Part slidingPart(const Joint& joint, int index)
{
  switch (joint.type)
  {
    case JointType::PRISMATIC:
      return {index, joint.v_index, 1, true};
    case JointType::PLANAR:
      return {index, joint.v_index, 2, true};
    case JointType::FLOATING:
      return {index, joint.v_index, 3, true};
    default:
      return {index, joint.v_index, 0, true};
  }
}

/** Projector on the principal axes [link axes] about which a link has no inertia. */
Eigen::Matrix3d axesWithoutInertia(const RigidInertia& inertia)
{
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(inertia.rotational);
  // A point mass has the square of its centre's round-off.
  const double least = ROUND_OFF * principal.eigenvalues().cwiseAbs().maxCoeff() +
                       ROUND_OFF * ROUND_OFF * inertia.mass * inertia.center.squaredNorm();
  Eigen::Matrix3d projector = Eigen::Matrix3d::Zero();
  for (int k = 0; k < 3; ++k)
    if (!(principal.eigenvalues()[k] > least))
      projector += principal.eigenvectors().col(k) * principal.eigenvectors().col(k).transpose();
  return projector;
}

/** The link alone has no inertia about its own joint. */
bool turnsWeakly(const Joint& joint, const RigidInertia& inertia)
{
  if (joint.type == JointType::FLOATING)
    return !axesWithoutInertia(inertia).isZero();
  // A planar joint's links turn about their centre: sliding is another coordinate.
  const double arm = joint.type == JointType::PLANAR ? 0.0 : joint.axis.cross(inertia.center).squaredNorm();
  const double largest = inertia.rotational.cwiseAbs().maxCoeff() + inertia.mass * inertia.center.squaredNorm();
  return !(joint.axis.dot(inertia.rotational * joint.axis) + inertia.mass * arm > ROUND_OFF * largest);
}

std::vector<Part> weakParts(const MultibodyModel& model)
{
  std::vector<Part> weak;
  for (int i = 0; i < static_cast<int>(model.joints.size()); ++i)
  {
    const Joint& joint = model.joints[i];
    const RigidInertia& inertia = model.links[i].inertia;
    const Part slides = slidingPart(joint, i);
    const int turning = velocitySize(joint.type) - slides.size;
    if (slides.size > 0 && !(inertia.mass > 0.0))
      weak.push_back(slides);
    if (turning > 0 && turnsWeakly(joint, inertia))
      weak.push_back({i, slides.first + slides.size, turning, false});
  }
  return weak;
}

/** A position without special angles. */
Eigen::VectorXd genericPosition(const MultibodyModel& model)
{
  Eigen::VectorXd q = zeroPosition(model);
  for (const Joint& joint : model.joints)
    if (joint.type != JointType::FLOATING)
      for (int k = joint.q_index; k < joint.q_index + positionSize(joint.type); ++k)
        q[k] = 0.7 + 0.3 * std::sin(1.7 * k);
  return q;
}

class JointInertia
{
public:
  JointInertia(MultibodyModel& model, const std::optional<double>& least)
    : model_(model), q_(genericPosition(model)), data_(model), parts_(weakParts(model))
  {
    updateMassMatrix();
    links_alone_ = data_.mass_matrix.diagonal();
    for (int k = 0; k < model_.nv; ++k)
      round_off_.push_back(ROUND_OFF * largestTerm(k));
    for (Part& part : parts_)
      part.load = carried(part);
    setLeast(least);
  }

  void addWhereNoneMoves()
  {
    while (Part* const part = nextToGive())  // the factorization at the start position has the last word
    {
      part->is_given = true;
      const double least = part->slides ? least_sliding_ : least_turning_;
      const double unfelt = part->load > 0.0 ? std::min(least, UNFELT_SHARE * part->load) : least;
      add(*part, std::max(unfelt, floor(*part)));
    }
  }

  /** After the leaders have theirs. */
  void lightenFollowers()
  {
    for (Part& part : parts_)
    {
      const auto [leader, ratio] = leaderOf(part.joint);
      if (!part.is_given || leader < 0)
        continue;
      const double felt = data_.mass_matrix(model_.joints[leader].v_index, model_.joints[leader].v_index);
      const double light = std::max(UNFELT_SHARE * felt / (ratio * ratio), floor(part));
      if (light < part.added)
        add(part, light);
    }
  }

  void addWhereHeldUp()
  {
    for (Part& part : parts_)
      if (!part.is_given)
        add(part, std::max(UNFELT_SHARE * part.load, floor(part)));
  }

  std::vector<std::string> warnings() const
  {
    std::string given;
    std::string following;
    std::string held_up;
    for (const Part& part : parts_)
    {
      if (!part.is_given && isGiven(part.joint))
        continue;  // named already
      const int leader = leaderOf(part.joint).first;
      std::string& list = !part.is_given ? held_up : leader < 0 ? given : following;
      list += (list.empty() ? "" : ", ") + (part.is_given ? describe(part, leader) : "'" + linkName(part) + "'");
    }
    std::vector<std::string> lines;
    if (!given.empty())
      lines.push_back("moves no inertia and gets min_joint_inertia: " + given);
    if (!following.empty())
      lines.push_back(
          "moves no inertia and follows its mimic, with an inertia that the joint followed does not feel: " +
          following);
    if (!held_up.empty())
      lines.push_back("without mass or with a singular inertia matrix, held up by what it carries: " + held_up);
    return lines;
  }

private:
  void updateMassMatrix()
  {
    forwardKinematics(model_, q_, data_);
    computeMassMatrix(model_, data_);
  }

  /** See addJointInertia. The radius of gyration is that of the links at the generic position. */
  void setLeast(const std::optional<double>& least)
  {
    least_sliding_ = least_turning_ = least.value_or(DEFAULT_JOINT_INERTIA);
    const double mass = model_.totalMass();
    if (least || !(mass > 0.0))
      return;
    const Eigen::Vector3d center = centerOfMass(model_, data_);
    double polar = 0.0;
    for (size_t i = 0; i < model_.links.size(); ++i)
    {
      const RigidInertia& inertia = model_.links[i].inertia;
      polar += 0.5 * inertia.rotational.trace() +
               inertia.mass * (data_.link_pose[i] * inertia.center - center).squaredNorm();
    }
    least_sliding_ = BODY_SHARE * mass;
    if (polar > 0.0)
      least_turning_ = BODY_SHARE * polar;
  }

  /** @return what the first coordinate whose pivot vanishes, and that has something left to give, is given */
  Part* nextToGive()
  {
    factorizeMassMatrix(model_, Eigen::VectorXd(), data_);
    for (int k = model_.nv - 1; k >= 0; --k)
    {
      const double root = data_.mass_factor(k, k);
      const bool stopped = !(root > 0.0);  // the pivot itself stands in its place, and nothing after it was computed
      if (stopped || root * root <= std::max(LEAST_PIVOT_RATIO * data_.mass_matrix(k, k), round_off_[k]))
        if (Part* const part = partToGive(k); part != nullptr || stopped)
          return part;
    }
    return nullptr;
  }

  /** Of the sum that makes a diagonal entry of M. */
  double largestTerm(int k) const
  {
    const WorldInertia& carried = data_.composite_inertia[model_.dof_link[k]];
    const double linear = data_.motion_subspace.col(k).head<3>().norm();
    const double angular = data_.motion_subspace.col(k).tail<3>().norm();
    return carried.mass * linear * linear + 2.0 * linear * angular * carried.moment.norm() +
           angular * angular * carried.rotational.norm();
  }

  /** What is to be given something for the pivot of `k`: a link that turns weakly may show it where it slides. */
  Part* partToGive(int k)
  {
    Part* found = nullptr;
    for (Part& part : parts_)
    {
      const bool holds = k >= part.first && k < part.first + part.size;
      if (part.joint == model_.dof_link[k] && !part.is_given && (holds || found == nullptr))
        found = &part;
    }
    return found;
  }

  /** What the part moves at the generic position, links that it turns about their own centre; 0 up to round-off. */
  double carried(const Part& part) const
  {
    if (model_.joints[part.joint].type == JointType::FLOATING && !part.slides)
    {
      const WorldInertia& whole = data_.composite_inertia[part.joint];
      const double steiner = whole.mass > 0.0 ? whole.moment.squaredNorm() / whole.mass : 0.0;
      const double about_center = 0.5 * whole.rotational.trace() - steiner;
      return about_center > ROUND_OFF * steiner ? about_center : 0.0;
    }
    double load = 0.0;
    for (int k = part.first; k < part.first + part.size; ++k)
      load = std::max(load, links_alone_[k] > round_off_[k] ? links_alone_[k] : 0.0);
    return load;
  }

  /** Least that is above round-off. */
  double floor(const Part& part) const
  {
    double least = 0.0;
    for (int k = part.first; k < part.first + part.size; ++k)
      least = std::max({least, LEAST_SHARE * links_alone_[k], 10.0 * round_off_[k]});
    return least;
  }

  /** Makes what was added to the part `inertia`. */
  void add(Part& part, double inertia)
  {
    const Joint& joint = model_.joints[part.joint];
    RigidInertia& link = model_.links[part.joint].inertia;
    if (joint.type != JointType::FLOATING)
      model_.armature.segment(part.first, part.size).setConstant(inertia);
    else if (part.slides)
      link.mass = inertia;
    else
      link.rotational += inertia * axesWithoutInertia(link);
    part.added = inertia;
    updateMassMatrix();
  }

  /** Joint at the head of a chain of mimics and the product of the multipliers on the way; -1 without one. */
  std::pair<int, double> leaderOf(int joint) const
  {
    double ratio = 1.0;
    int leader = -1;
    for (const Mimic* mimic = &model_.joints[joint].mimic; mimic->joint >= 0;
         mimic = &model_.joints[mimic->joint].mimic)
    {
      leader = mimic->joint;
      ratio *= mimic->multiplier;
    }
    return {leader, ratio};
  }

  bool isGiven(int joint) const
  {
    return std::any_of(
        parts_.begin(), parts_.end(), [joint](const Part& part) { return part.joint == joint && part.is_given; });
  }

  const std::string& linkName(const Part& part) const { return model_.links[part.joint].name; }

  std::string describe(const Part& part, int leader) const
  {
    const Joint& joint = model_.joints[part.joint];
    std::ostringstream text;
    if (leader >= 0)
      text << "joint '" << joint.name << "' (follows '" << model_.joints[joint.mimic.joint].name << "')";
    else if (joint.name.empty())
      text << "floating base '" << linkName(part) << "' " << part.added << (part.slides ? " kg" : " kg m^2");
    else
      text << "joint '" << joint.name << "' " << part.added << (part.slides ? " kg" : " kg m^2");
    return text.str();
  }

  MultibodyModel& model_;
  const Eigen::VectorXd q_;
  MultibodyData data_;
  std::vector<Part> parts_;
  Eigen::VectorXd links_alone_;  ///< nv, diagonal of M before anything was added
  std::vector<double> round_off_;  ///< nv, of the same
  double least_sliding_ = 0.0;  ///< [kg]
  double least_turning_ = 0.0;  ///< [kg m^2]
};
}  // namespace

std::vector<std::string> addJointInertia(MultibodyModel& model, const std::optional<double>& least)
{
  JointInertia inertia(model, least);
  inertia.addWhereNoneMoves();
  inertia.lightenFollowers();
  inertia.addWhereHeldUp();
  return inertia.warnings();
}

}  // namespace frictional_contact_sim
