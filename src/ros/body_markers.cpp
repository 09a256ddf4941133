#include "frictional_contact_sim/ros/body_markers.h"

#include <filesystem>
#include <set>

#include "frictional_contact_sim/model/model_error.h"
#include "frictional_contact_sim/model/urdf_loader.h"
#include "frictional_contact_sim/model/visual_shapes.h"
#include "frictional_contact_sim/ros/conversions.h"
#include "frictional_contact_sim/ros/markers.h"
#include "frictional_contact_sim/simulation/body_document.h"

namespace frictional_contact_sim
{
namespace
{
using visualization_msgs::Marker;

constexpr float OPACITY = 0.55F;  ///< of bodies: arrows inside them are seen
constexpr double GROUND_SIZE = 20.0;  ///< edge, in sizes of the scene

/** Of bodies without colours: calm ones, away from those of the modes. */
std_msgs::ColorRGBA paletteColor(int body)
{
  constexpr double COLORS[][3] = {{0.55, 0.60, 0.70}, {0.75, 0.65, 0.50}, {0.60, 0.50, 0.70}, {0.50, 0.70, 0.70},
                                  {0.75, 0.55, 0.60}, {0.70, 0.70, 0.45}, {0.45, 0.55, 0.55}, {0.65, 0.65, 0.65}};
  constexpr int COUNT = sizeof COLORS / sizeof COLORS[0];
  const double* rgb = COLORS[body % COUNT];
  return makeColor(rgb[0], rgb[1], rgb[2], OPACITY);
}

/** Elastic bodies do; a rod is its sections' shapes. */
bool hasSurface(const Simulator& simulator, int body)
{
  const auto& solid = simulator.workspace(body).model.solid;
  return solid && !solid->facets().empty();
}

bool fileExists(const std::string& uri)
{
  try
  {
    return std::filesystem::exists(resolvePath(uri, "."));
  }
  catch (const ModelError&)
  {
    return false;
  }
}
}  // namespace

BodyMarkers::BodyMarkers(const Simulator& simulator) : simulator_(simulator)
{
}

void BodyMarkers::addMarker(int body, int link, int type, const Eigen::Vector3d& scale,
                            const Eigen::Isometry3d& placement, const std_msgs::ColorRGBA& color)
{
  Marker marker;
  marker.header.frame_id = WORLD_FRAME;
  marker.ns = "bodies";
  marker.id = static_cast<int>(markers_.size());
  marker.type = type;
  marker.action = Marker::ADD;
  marker.scale.x = scale.x();
  marker.scale.y = scale.y();
  marker.scale.z = scale.z();
  marker.color = color;
  markers_.push_back(marker);
  shapes_.push_back({body, link, placement});
}

void BodyMarkers::add(int body, int link, const Geometry& geometry, const Eigen::Isometry3d& placement,
                      const std_msgs::ColorRGBA& color)
{
  const auto at = [&](int type, const Eigen::Vector3d& scale, double z = 0.0)
  { addMarker(body, link, type, scale, placement * Eigen::Translation3d(0.0, 0.0, z), color); };
  if (const auto* sphere = std::get_if<Sphere>(&geometry))
    at(Marker::SPHERE, Eigen::Vector3d::Constant(2.0 * sphere->radius));
  else if (const auto* box = std::get_if<Box>(&geometry))
    at(Marker::CUBE, 2.0 * box->half_size);
  else if (const auto* cylinder = std::get_if<Cylinder>(&geometry))
    at(Marker::CYLINDER, 2.0 * Eigen::Vector3d(cylinder->radius, cylinder->radius, cylinder->half_length));
  else if (const auto* capsule = std::get_if<Capsule>(&geometry))
  {
    const double diameter = 2.0 * capsule->radius;
    if (capsule->half_length > 0.0)
      at(Marker::CYLINDER, Eigen::Vector3d(diameter, diameter, 2.0 * capsule->half_length));
    at(Marker::SPHERE, Eigen::Vector3d::Constant(diameter), capsule->half_length);
    at(Marker::SPHERE, Eigen::Vector3d::Constant(diameter), -capsule->half_length);
  }
  else if (const auto* mesh = std::get_if<Mesh>(&geometry))
  {
    at(Marker::MESH_RESOURCE, mesh->scale);
    markers_.back().mesh_resource = mesh->path.front() == '/' ? "file://" + mesh->path : mesh->path;
  }
}

/** A deformable body is its surface: triangles, or the outline of a plane body or bar. */
void BodyMarkers::loadSurface(int body)
{
  const std::vector<Facet>& facets = simulator_.workspace(body).model.solid->facets();
  const bool is_solid = !facets.empty() && facets.front().count == 3;
  addMarker(body, 0, is_solid ? Marker::TRIANGLE_LIST : Marker::LINE_LIST, Eigen::Vector3d::Ones(),
            Eigen::Isometry3d::Identity(), paletteColor(body));
  Marker& marker = markers_.back();
  marker.color.a = 1.0F;
  if (!is_solid)
    marker.scale.x = 0.1 * simulator_.workspace(body).model.solid->nodeDistance();
}

void BodyMarkers::fillSurface(int body, Marker& marker) const
{
  const MultibodyData& data = simulator_.data(body);
  marker.points.clear();
  for (const Facet& facet : simulator_.workspace(body).model.solid->facets())
    for (int k = 0; k < facet.count; ++k)
    {
      const Eigen::Vector3d& node = data.link_pose[facet.links[k]].translation();
      geometry_msgs::Point point;
      point.x = node.x();
      point.y = node.y();
      point.z = node.z();
      marker.points.push_back(point);
    }
  fillPose(Eigen::Isometry3d::Identity(), marker.pose);
}

void BodyMarkers::loadBody(int body)
{
  if (hasSurface(simulator_, body))
  {
    loadSurface(body);
    return;
  }
  const MultibodyModel& model = simulator_.model(body);
  std::set<int> drawn;  // frames
  std::vector<VisualShape> visuals;
  if (!simulator_.workspace(body).model.solid)
  {
    const BodyDocument document = bodyDocument(simulator_.scenario().bodies[body]);
    visuals = readVisualShapes(document.urdf, document.folder);
  }
  for (const VisualShape& shape : visuals)
  {
    const int frame = model.findFrame(shape.link);
    const auto* mesh = std::get_if<Mesh>(&shape.geometry);
    if (frame < 0 || (mesh != nullptr && !fileExists(mesh->path)))
      continue;
    std_msgs::ColorRGBA color = paletteColor(body);
    if (shape.color)
      color = makeColor((*shape.color)[0], (*shape.color)[1], (*shape.color)[2],
                        std::min<double>(OPACITY, (*shape.color)[3]));
    add(body, model.frames[frame].link, shape.geometry, model.frames[frame].placement * shape.placement, color);
    drawn.insert(frame);
  }
  for (const CollisionShape& shape : model.shapes)
    if (drawn.count(shape.frame) == 0)
      add(body, shape.link, shape.geometry, shape.placement, paletteColor(body));
}

void BodyMarkers::load(double size)
{
  if (const std::optional<GroundSpec>& ground = simulator_.scenario().ground)
  {
    // Two triangles: the shading of a cube that is scaled to a plate is wrong.
    addMarker(-1, -1, Marker::TRIANGLE_LIST, Eigen::Vector3d::Ones(),
              Eigen::Isometry3d(Eigen::Translation3d(0.0, 0.0, ground->height)), makeColor(0.82, 0.82, 0.80, 1.0));
    constexpr int CORNERS[][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, -1}, {1, 1}, {-1, 1}};
    for (const auto& corner : CORNERS)
    {
      geometry_msgs::Point point;
      point.x = 0.5 * GROUND_SIZE * size * corner[0];
      point.y = 0.5 * GROUND_SIZE * size * corner[1];
      markers_.back().points.push_back(point);
      markers_.back().colors.push_back(markers_.back().color);
    }
  }
  for (int body = 0; body < simulator_.bodyCount(); ++body)
    loadBody(body);
}

void BodyMarkers::append(const ros::Time& stamp, double size, visualization_msgs::MarkerArray& message)
{
  if (!loaded_)
    load(size);
  loaded_ = true;
  for (size_t i = 0; i < markers_.size(); ++i)
  {
    const Shape& shape = shapes_[i];
    const Eigen::Isometry3d pose =
        shape.body < 0 ? shape.placement : simulator_.data(shape.body).link_pose[shape.link] * shape.placement;
    if (shape.body >= 0 && hasSurface(simulator_, shape.body))
      fillSurface(shape.body, markers_[i]);
    else
      fillPose(pose, markers_[i].pose);
    markers_[i].header.stamp = stamp;
  }
  message.markers.insert(message.markers.end(), markers_.begin(), markers_.end());
}

}  // namespace frictional_contact_sim
