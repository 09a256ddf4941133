#include "frictional_contact_sim/model/model_error.h"

#include <algorithm>

namespace frictional_contact_sim
{
void failAt(const std::string& source, int line, const std::string& text)
{
  std::string message = source + (line > 0 ? ":" + std::to_string(line) : "") + ": " + text;
  std::replace_if(
      message.begin(), message.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
  throw ModelError(message);
}

}  // namespace frictional_contact_sim
