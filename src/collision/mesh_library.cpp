#include "mesh_library.h"

#include "frictional_contact_sim/model/model_error.h"

namespace frictional_contact_sim
{
std::vector<ConvexShape> MeshLibrary::shapesOf(const Geometry& geometry, const std::string& link,
                                               std::vector<std::string>* warnings)
{
  const Mesh* mesh = std::get_if<Mesh>(&geometry);
  if (mesh == nullptr)
    return {makeShape(geometry)};
  const auto key = std::make_tuple(mesh->path, mesh->scale.x(), mesh->scale.y(), mesh->scale.z());
  auto found = entries_.find(key);
  if (found == entries_.end())
  {
    auto entry = std::make_shared<Entry>();
    try
    {
      entry->hulls = loadMeshHulls(mesh->path, mesh->scale, entry->addition);
    }
    catch (const ModelError& error)
    {
      throw ModelError("link '" + link + "': collision mesh " + error.what());
    }
    found = entries_.emplace(key, std::move(entry)).first;
  }
  const Entry& entry = *found->second;
  if (warnings != nullptr && !entry.addition.empty())
    warnings->push_back("link '" + link + "': collision mesh " + mesh->path + ": " + entry.addition);
  std::vector<ConvexShape> shapes;
  for (const Polyhedron& hull : entry.hulls)
    shapes.push_back(makeShape(hull));
  return shapes;
}

}  // namespace frictional_contact_sim
