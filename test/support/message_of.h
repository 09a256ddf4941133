#pragma once
/**
 * @file message_of.h
 * @brief What an action says when it throws.
 */
#include <exception>
#include <string>

namespace frictional_contact_sim
{
namespace test_support
{
/** @return the message of the exception, "no error" where there is none */
template <class Action>
std::string messageOf(const Action& action)
{
  try
  {
    action();
  }
  catch (const std::exception& error)
  {
    return error.what();
  }
  return "no error";
}

}  // namespace test_support
}  // namespace frictional_contact_sim
