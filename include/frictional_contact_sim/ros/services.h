#pragma once
/**
 * @file services.h
 * @brief The node's services as a table of name and handler, and the one frame around all of them. **To add a
 * service**: one line `table.add<Type>("name", handler)`.
 *
 * A handler checks the request, acts, fills the response, and throws for a request it does not take, before it has
 * changed anything. Handlers run in the node's one thread, between steps.
 */
#include <ros/console.h>
#include <ros/node_handle.h>

#include <functional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace frictional_contact_sim
{
/** @brief One line: the field of a request, what was found there, what is expected. */
class RequestError : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

/** @brief True for responses with `success` and `message`; std_srvs/Empty has none. */
template <typename Response, typename = void>
struct HasSuccess : std::false_type
{
};
template <typename Response>
struct HasSuccess<Response, std::void_t<decltype(Response::success), decltype(Response::message)>> : std::true_type
{
};

/**
 * @brief Runs a handler: success = true, or false and the reason in `message` when it throws. Other fields stay as the
 * handler left them.
 * @return what roscpp wants: false (an exception at the caller) only where the response cannot say it
 */
template <typename Response>
bool answer(const std::string& name, Response& response, const std::function<void()>& handler)
{
  std::string reason;
  bool success = true;
  try
  {
    handler();
  }
  catch (const std::exception& error)
  {
    success = false;
    reason = error.what();
    ROS_DEBUG_STREAM("~" << name << ": refused: " << reason);
  }
  if constexpr (HasSuccess<Response>::value)
  {
    response.success = success;
    if (!success)
      response.message = reason;
    return true;
  }
  else
  {
    return success;
  }
}

class ServiceTable
{
public:
  template <typename Service>
  using Handler = std::function<void(const typename Service::Request&, typename Service::Response&)>;

  explicit ServiceTable(const ros::NodeHandle& private_node) : node_(private_node) {}
  ServiceTable(const ServiceTable&) = delete;
  ServiceTable& operator=(const ServiceTable&) = delete;

  /** @brief Advertises ~name. @param Service its type, such as frictional_contact_sim::Step */
  template <typename Service>
  void add(const std::string& name, const Handler<Service>& handler)
  {
    using Request = typename Service::Request;
    using Response = typename Service::Response;
    servers_.push_back(node_.advertiseService<Request, Response>(
        name, [name, handler](Request& request, Response& response)
        { return answer(name, response, [&] { handler(request, response); }); }));
  }
  /** @brief Advertises ~name of type std_srvs/Empty. */
  void add(const std::string& name, const std::function<void()>& action);

private:
  ros::NodeHandle node_;
  std::vector<ros::ServiceServer> servers_;
};

}  // namespace frictional_contact_sim
