#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <stdexcept>

#include "frictional_contact_sim/collision/polyhedron.h"
#include "frictional_contact_sim/model/model_error.h"
#include "polyhedron_topology.h"

namespace frictional_contact_sim
{
namespace
{
void addMesh(const aiMesh& mesh, const aiMatrix4x4& pose, const Eigen::Vector3d& scale, MeshPart& part)
{
  const int first = static_cast<int>(part.vertices.size());
  for (unsigned v = 0; v < mesh.mNumVertices; ++v)
  {
    const aiVector3D point = pose * mesh.mVertices[v];
    part.vertices.push_back(Eigen::Vector3d(point.x, point.y, point.z).cwiseProduct(scale));
  }
  for (unsigned f = 0; f < mesh.mNumFaces; ++f)
  {
    const aiFace& face = mesh.mFaces[f];
    for (unsigned k = 2; k < face.mNumIndices; ++k)
      part.triangles.push_back({first + static_cast<int>(face.mIndices[0]),
                                first + static_cast<int>(face.mIndices[k - 1]),
                                first + static_cast<int>(face.mIndices[k])});
  }
}

/// A part for each node with meshes. assimp cuts an object where its material changes, but leaves it one node.
void addParts(const aiScene& scene, const aiNode& node, const aiMatrix4x4& parent_pose, const Eigen::Vector3d& scale,
              std::vector<MeshPart>& parts)
{
  const aiMatrix4x4 pose = parent_pose * node.mTransformation;
  MeshPart part;
  part.name = node.mName.C_Str();
  for (unsigned m = 0; m < node.mNumMeshes; ++m)
    addMesh(*scene.mMeshes[node.mMeshes[m]], pose, scale, part);
  if (!part.vertices.empty())
    parts.push_back(std::move(part));
  for (unsigned c = 0; c < node.mNumChildren; ++c)
    addParts(scene, *node.mChildren[c], pose, scale, parts);
}

/// Vertices are compared by their places: files repeat them for every triangle or every normal.
bool isClosed(const MeshPart& part)
{
  const Precision precision = precisionOf(part.vertices);
  if (!(precision.size > 0.0) || !std::isfinite(precision.size))
    return false;
  std::vector<int> number;
  weld(part.vertices, precision.weld, &number);
  std::vector<std::array<int, 2>> sides;
  for (const std::array<int, 3>& triangle : part.triangles)
  {
    const int i = number[triangle[0]];
    const int j = number[triangle[1]];
    const int k = number[triangle[2]];
    if (i == j || j == k || i == k)
      continue;
    for (const auto& [from, to] : {std::make_pair(i, j), std::make_pair(j, k), std::make_pair(k, i)})
      sides.push_back({std::min(from, to), std::max(from, to)});
  }
  std::sort(sides.begin(), sides.end());
  for (size_t k = 0; k + 1 < sides.size(); k += 2)
    if (sides[k] != sides[k + 1] || (k + 2 < sides.size() && sides[k] == sides[k + 2]))
      return false;
  return !sides.empty() && sides.size() % 2 == 0;
}

/// Closed parts first, then one of all others.
std::vector<MeshPart> grouped(std::vector<MeshPart> parts)
{
  std::vector<MeshPart> closed;
  MeshPart open;
  for (MeshPart& part : parts)
  {
    part.is_closed = isClosed(part);
    if (part.is_closed)
    {
      closed.push_back(std::move(part));
      continue;
    }
    const int first = static_cast<int>(open.vertices.size());
    if (open.vertices.empty())
      open.name = part.name;
    open.vertices.insert(open.vertices.end(), part.vertices.begin(), part.vertices.end());
    for (const std::array<int, 3>& triangle : part.triangles)
      open.triangles.push_back({first + triangle[0], first + triangle[1], first + triangle[2]});
  }
  if (!open.vertices.empty())
  {
    open.is_closed = isClosed(open);  // faces of a box as objects of their own: together they are one
    closed.push_back(std::move(open));
  }
  return closed;
}
}  // namespace

std::vector<MeshPart> readMeshParts(const std::string& path, const Eigen::Vector3d& scale)
{
  Assimp::Importer importer;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFile(path, 0);
  if (!scene || !scene->mRootNode)
  {
    std::string reason = importer.GetErrorString();
    reason = reason.substr(0, reason.find('\n'));
    throw ModelError(path + ": mesh cannot be read: " + (reason.empty() ? "unknown reason" : reason));
  }
  std::vector<MeshPart> parts;
  addParts(*scene, *scene->mRootNode, aiMatrix4x4(), scale, parts);
  if (parts.empty())
    throw ModelError(path + ": mesh has no vertices");
  return grouped(std::move(parts));
}

std::vector<Eigen::Vector3d> readMesh(const std::string& path, const Eigen::Vector3d& scale)
{
  std::vector<Eigen::Vector3d> vertices;
  for (const MeshPart& part : readMeshParts(path, scale))
    vertices.insert(vertices.end(), part.vertices.begin(), part.vertices.end());
  return vertices;
}

Polyhedron loadMeshHull(const std::string& path, const Eigen::Vector3d& scale)
{
  const std::vector<Eigen::Vector3d> vertices = readMesh(path, scale);
  try
  {
    return convexHull(vertices);
  }
  catch (const std::invalid_argument& error)
  {
    throw ModelError(path + ": mesh has no convex hull: " + error.what());
  }
}

}  // namespace frictional_contact_sim
