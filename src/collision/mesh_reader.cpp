#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <stdexcept>

#include "frictional_contact_sim/collision/polyhedron.h"
#include "frictional_contact_sim/model/model_error.h"

namespace frictional_contact_sim
{
namespace
{
void addVertices(const aiScene& scene, const aiNode& node, const aiMatrix4x4& parent_pose, const Eigen::Vector3d& scale,
                 std::vector<Eigen::Vector3d>& vertices)
{
  const aiMatrix4x4 pose = parent_pose * node.mTransformation;
  for (unsigned m = 0; m < node.mNumMeshes; ++m)
  {
    const aiMesh& mesh = *scene.mMeshes[node.mMeshes[m]];
    for (unsigned v = 0; v < mesh.mNumVertices; ++v)
    {
      const aiVector3D point = pose * mesh.mVertices[v];
      vertices.push_back(Eigen::Vector3d(point.x, point.y, point.z).cwiseProduct(scale));
    }
  }
  for (unsigned c = 0; c < node.mNumChildren; ++c)
    addVertices(scene, *node.mChildren[c], pose, scale, vertices);
}
}  // namespace

std::vector<Eigen::Vector3d> readMesh(const std::string& path, const Eigen::Vector3d& scale)
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
  std::vector<Eigen::Vector3d> vertices;
  addVertices(*scene, *scene->mRootNode, aiMatrix4x4(), scale, vertices);
  if (vertices.empty())
    throw ModelError(path + ": mesh has no vertices");
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
