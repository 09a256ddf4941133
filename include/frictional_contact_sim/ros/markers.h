#pragma once
/**
 * @file markers.h
 * @brief Contacts as rviz markers, coloured by mode: sticking green, sliding orange, impact blue, open grey.
 * Namespaces: `force` an arrow for each contact, `cone` the friction cones, `value` the force between two shapes in
 * newtons, `blocking` red balls where the last verdict on existence is REFUTED or about to be, `legend`.
 */
#include <ros/time.h>
#include <std_msgs/ColorRGBA.h>
#include <visualization_msgs/MarkerArray.h>

#include "frictional_contact_sim/simulation/simulator.h"

namespace frictional_contact_sim
{
/** @brief Components in [0, 1]. */
std_msgs::ColorRGBA makeColor(double red, double green, double blue, double opacity);

/** @brief How large things are drawn. */
struct MarkerScale
{
  double size = 1.0;  ///< of the scene: diameter of the largest body that moves [m]
  double force = 0.01;  ///< length of arrows [m/N]
  Eigen::Vector3d legend = Eigen::Vector3d::Zero();  ///< its place in the world [m]
};

/**
 * @brief From the bodies as they are now.
 * @param force_scale [m/N]; 0: the size of the scene for the weight of the heaviest, 0.01 m/N where nothing has weight
 */
MarkerScale markerScale(const Simulator& simulator, double force_scale);

/** @brief Markers of a message, of the namespaces that change in number. */
struct MarkerCounts
{
  size_t arrows = 0;
  size_t values = 0;
  size_t blocking = 0;
};

/**
 * @brief Adds the markers of all contacts to the message, and the legend. An arrow is at least a tenth and at most one
 * and a half of the scene's size long, whatever the force; its value says the truth.
 * @param previous in the message before this one: those that are gone are deleted
 * @return in this message
 */
MarkerCounts appendContactMarkers(const Simulator& simulator, const ros::Time& stamp, const MarkerScale& scale,
                                  const MarkerCounts& previous, visualization_msgs::MarkerArray& message);

}  // namespace frictional_contact_sim
