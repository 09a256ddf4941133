#pragma once
/**
 * @file nearest_name.h
 * @brief What a misspelt name was meant to be.
 */
#include <string>
#include <vector>

namespace frictional_contact_sim
{
/** @brief Letters to insert, delete, replace or swap with their neighbour to get from one name to the other; case is
 * ignored. (Damerau's distance, each letter touched once.) */
int editDistance(const std::string& a, const std::string& b);

/** @brief The valid name with the least distance, where that is at most a third of the letters; else "". */
std::string nearestName(const std::string& found, const std::vector<std::string>& valid);

/** @brief "did you mean 'gravity'? ", or "" when no valid name is near. */
std::string didYouMean(const std::string& found, const std::vector<std::string>& valid);

/** @brief "a, b, c". */
std::string joinNames(const std::vector<std::string>& names);

/** @brief "a, b or c". */
std::string eitherOf(const std::vector<std::string>& names);

/** @brief The text in one line: control characters become spaces, and what is longer than a line's worth is cut. */
std::string inOneLine(const std::string& text, size_t longest = 1000);

}  // namespace frictional_contact_sim
