#pragma once
/**
 * @file body_markers.h
 * @brief The bodies of a scenario as rviz markers (namespace `bodies`), so that it is seen without a robot_description.
 */
#include <visualization_msgs/MarkerArray.h>

#include <vector>

#include "frictional_contact_sim/simulation/simulator.h"

namespace frictional_contact_sim
{
class BodyMarkers
{
public:
  /** @brief Reads nothing yet: pictures are made when somebody looks. */
  explicit BodyMarkers(const Simulator& simulator);

  /**
   * @brief Adds a marker for each shape at its present place: what the URDF draws of a link, else what collides; in the
   * URDF's colours, else one a body; and a large piece of the ground. Translucent: forces are seen through it.
   * @param size of the scene [m]
   */
  void append(const ros::Time& stamp, double size, visualization_msgs::MarkerArray& message);

private:
  struct Shape
  {
    int body;  // -1: the ground
    int link;
    Eigen::Isometry3d placement;  // in the link, or in the world
  };

  void load(double size);
  void loadBody(int body);
  void loadSurface(int body);
  void fillSurface(int body, visualization_msgs::Marker& marker) const;
  void add(int body, int link, const Geometry& geometry, const Eigen::Isometry3d& placement,
           const std_msgs::ColorRGBA& color);
  void addMarker(int body, int link, int type, const Eigen::Vector3d& scale, const Eigen::Isometry3d& placement,
                 const std_msgs::ColorRGBA& color);

  const Simulator& simulator_;
  bool loaded_ = false;
  std::vector<Shape> shapes_;
  std::vector<visualization_msgs::Marker> markers_;  // of the shapes
};

}  // namespace frictional_contact_sim
