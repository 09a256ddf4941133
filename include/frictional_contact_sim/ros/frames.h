#pragma once
/**
 * @file frames.h
 * @brief Names in requests to bodies, links and poses in the frame `world`.
 *
 * Own links are known by their names on topics and as body/link; their poses are those of the present state, without
 * waiting. Other frames come from tf2: relative to the nearest own link above them, where there is one, so that they
 * move with the present state too. The listener is made with the first request that names such a frame, so that a node
 * that is never asked listens to no transforms; that request waits FIRST_WAIT at most, later ones do not wait.
 */
#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <string>

#include "frictional_contact_sim/ros/names.h"

namespace frictional_contact_sim
{
/** @brief A URDF link of a body. */
struct LinkHandle
{
  int body = 0;
  int frame = 0;  ///< in the body's model
};

/** @brief A link by its name on topics or as body/link. */
std::optional<LinkHandle> findLink(const Simulator& simulator, const NameTable& names, const std::string& name);

/** @param body may be empty when there is one only. @param field of the request @throws RequestError */
int requireBody(const NameTable& names, const std::string& body, const std::string& field = "body");

/**
 * @brief The link that fields `body` and `link` of a request name.
 * @param body may be empty when there is one only, or when the link's name is unique
 * @throws RequestError
 */
LinkHandle requireLink(const Simulator& simulator, const NameTable& names, const std::string& body,
                       const std::string& link);

/** @brief The same; an empty link is the root link. */
LinkHandle requireLinkOrRoot(const Simulator& simulator, const NameTable& names, const std::string& body,
                             const std::string& link);

Eigen::Isometry3d linkPose(const Simulator& simulator, const LinkHandle& link);

class FrameResolver
{
public:
  static constexpr double FIRST_WAIT = 1.0;  ///< wall clock [s]

  /** @param use_tf false: own frames only, no ROS master needed */
  FrameResolver(const Simulator& simulator, const NameTable& names, bool use_tf);
  ~FrameResolver();

  /**
   * @brief Pose of a frame in the world at the present state; an empty name is `world`.
   * @param field of the request, for the message
   * @throws RequestError when neither the simulation nor tf knows the frame
   */
  Eigen::Isometry3d pose(const std::string& field, const std::string& frame_id);

private:
  struct Transforms;
  Eigen::Isometry3d foreignPose(const std::string& field, const std::string& frame_id);
  std::optional<Eigen::Isometry3d> lookUp(const std::string& frame_id) const;

  const Simulator& simulator_;
  const NameTable& names_;
  bool use_tf_;
  std::unique_ptr<Transforms> transforms_;
};

}  // namespace frictional_contact_sim
