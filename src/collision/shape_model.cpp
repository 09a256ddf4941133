#include "shape_model.h"

#include <algorithm>

namespace frictional_contact_sim
{
namespace
{
bool contains(const std::vector<std::array<int, 2>>& sorted, const std::array<int, 2>& pair)
{
  return std::binary_search(sorted.begin(), sorted.end(), pair);
}
}  // namespace

bool ShapeModel::mayCollide(int i, int k) const
{
  if (instances[i].is_immobile && instances[k].is_immobile)
    return false;
  const ShapeInfo& first = infos[i];
  const ShapeInfo& second = infos[k];
  if (first.body < 0 || second.body < 0)
  {
    const ShapeInfo& moving = first.body < 0 ? second : first;
    return !contains(bodies[moving.body].disabled_static, {moving.frame, first.body < 0 ? i : k});
  }
  if (!joined.empty())
  {
    std::array<int, 2> one{first.body, first.link};
    std::array<int, 2> other{second.body, second.link};
    if (other < one)
      std::swap(one, other);
    if (std::binary_search(joined.begin(), joined.end(), std::array<int, 4>{one[0], one[1], other[0], other[1]}))
      return false;
  }
  if (first.body != second.body)
    return true;
  const CollidingBody& body = bodies[first.body];
  const bool is_adjacent =
      first.link == second.link || body.parent[first.link] == second.link || body.parent[second.link] == first.link;
  return !is_adjacent && body.collides_with_itself &&
         !contains(body.disabled, {std::min(first.frame, second.frame), std::max(first.frame, second.frame)});
}

void ShapeModel::arrange(const std::vector<int>& old_handles)
{
  std::vector<int> new_handle(instances.size(), -1);
  std::vector<Instance> old_instances = std::move(instances);
  std::vector<ShapeInfo> old_infos = std::move(infos);
  instances.clear();
  infos.clear();
  for (const int old : old_handles)
  {
    new_handle[old] = static_cast<int>(instances.size());
    instances.push_back(std::move(old_instances[old]));
    infos.push_back(std::move(old_infos[old]));
  }
  for (CollidingBody& body : bodies)
  {
    for (int& handle : body.shapes)
      handle = new_handle[handle];
    body.shapes.erase(std::remove(body.shapes.begin(), body.shapes.end(), -1), body.shapes.end());
    for (std::array<int, 2>& pair : body.disabled_static)
      pair[1] = new_handle[pair[1]];
    std::sort(body.disabled_static.begin(), body.disabled_static.end());
  }
}

void ShapeModel::eraseBody(int body)
{
  bodies.erase(bodies.begin() + body);
  for (ShapeInfo& info : infos)
    info.body -= info.body > body ? 1 : 0;
  joined.erase(std::remove_if(joined.begin(), joined.end(),
                              [body](const std::array<int, 4>& pair) { return pair[0] == body || pair[2] == body; }),
               joined.end());
  for (std::array<int, 4>& pair : joined)
    for (const int place : {0, 2})
      pair[static_cast<size_t>(place)] -= pair[static_cast<size_t>(place)] > body ? 1 : 0;
}

}  // namespace frictional_contact_sim
