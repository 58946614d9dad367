// Texts with a few random edits, for readers that refuse what they cannot read.
#pragma once

#include <cstddef>
#include <random>
#include <string>

namespace fjr {

// Returns the text with one to three edits: bytes lost, changed or repeated, and characters that mean something in
// YAML.
inline std::string mutated(std::string text, std::mt19937& random) {
  static const std::string kBytes = "{}[],:-#&*!|>'\"%@`?0123456789e.~<=\n\t ";
  const int edits = 1 + static_cast<int>(random() % 3);
  for (int e = 0; e < edits && !text.empty(); ++e) {
    const std::size_t at = random() % text.size();
    switch (random() % 4) {
      case 0:
        text.erase(at, 1 + random() % 8);
        break;
      case 1:
        text.insert(at, 1, kBytes[random() % kBytes.size()]);
        break;
      case 2:
        text[at] = static_cast<char>(random() % 256);
        break;
      default:
        text.insert(at, text.substr(random() % text.size(), random() % 12));
        break;
    }
  }
  return text;
}

}  // namespace fjr
