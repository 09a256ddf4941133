#pragma once
/**
 * @file model_error.h
 * @brief What is thrown when a robot's file, or a mesh of it, is not what it must be.
 */
#include <stdexcept>
#include <string>

namespace frictional_contact_sim
{
/** @brief One line: the file, what was found and expected. */
class ModelError : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

/** @brief Throws ModelError "source:line: text", one line whatever the text holds; no line number when it is 0. */
[[noreturn]] void failAt(const std::string& source, int line, const std::string& text);

}  // namespace frictional_contact_sim
