#include "flexarm/number_rows.hpp"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <limits>
#include <string>

#include "flexarm/errors.hpp"

namespace flexarm {
namespace {

std::string_view without_blanks(std::string_view text) {
  constexpr std::string_view blanks = " \t\r\v\f";
  const auto first = text.find_first_not_of(blanks);
  return first == text.npos ? std::string_view{}
                            : text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

/// Takes what stands before the next mark off the text, and the mark too.
std::string_view take_until(char mark, std::string_view& text) {
  const auto found = text.substr(0, text.find(mark));
  text.remove_prefix(std::min(found.size() + 1, text.size()));
  return found;
}

/// The number that fills a text, as std::from_chars takes it; some libraries have none for numbers with a
/// point.
std::optional<double> plain_number(std::string_view text) {
#if __cpp_lib_to_chars >= 201611L
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc{} && end == text.data() + text.size();
#else
  const std::string copy(text);
  char* end = nullptr;
  const double value = std::strtod(copy.c_str(), &end);
  const bool whole = end == copy.c_str() + copy.size() && copy.find_first_of("xX") == copy.npos;
#endif
  return whole && text.back() != ')' ? std::optional(value) : std::nullopt;  // no nan(1)
}

std::optional<double> number(std::string_view cell) {
  cell = without_blanks(cell);
  if (cell.empty()) return std::numeric_limits<double>::quiet_NaN();
  if (cell.front() == '+') {
    cell.remove_prefix(1);
    if (cell.empty() || cell.front() == '-' || cell.front() == '+') return std::nullopt;
  }
  return plain_number(cell);
}

}  // namespace

std::optional<RowMatrix> number_rows(std::string_view text, int cells, const std::vector<int>& columns) {
  for (const int column : columns) {
    if (column < 0 || column >= cells) throw InvalidParameter("a column must be one of the cells of a row");
  }
  std::vector<std::string_view> row;
  std::vector<double> found;
  Eigen::Index count = 0;
  while (!text.empty()) {
    std::string_view line = take_until('\n', text);
    const auto words = without_blanks(line);
    if (words.empty() || words.front() == '#') continue;
    row.clear();
    const bool ends_empty = line.back() == ',';
    while (!line.empty()) row.push_back(take_until(',', line));
    if (ends_empty) row.emplace_back();
    if (row.size() != static_cast<std::size_t>(cells)) return std::nullopt;
    for (const int column : columns) {
      const auto value = number(row[static_cast<std::size_t>(column)]);
      if (!value) return std::nullopt;
      found.push_back(*value);
    }
    ++count;
  }
  return Eigen::Map<const RowMatrix>(found.data(), count, static_cast<Eigen::Index>(columns.size()));
}

}  // namespace flexarm
