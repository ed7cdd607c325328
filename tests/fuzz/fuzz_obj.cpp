#include "tests/fuzz/fuzz_model.h"

namespace {

constexpr std::string_view kBlanks = " \t\v\f\r";

bool is_blank(char c) {
  return kBlanks.find(c) != std::string_view::npos;
}

std::size_t count_words(std::string_view text) {
  std::size_t words = 0;
  for (std::size_t i = 0; i < text.size(); ++i)
    if (!is_blank(text[i]) && (i == 0 || is_blank(text[i - 1]))) ++words;
  return words;
}

// Of n corners become n - 2 triangles. For files of plain lines alone: without lines that go on in the next
// and without comments, as those are for the reader to understand.
std::size_t promised_triangles(std::string_view text) {
  std::size_t triangles = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
    if (line.size() > 1 && line[0] == 'f' && is_blank(line[1]))
      triangles += std::max<std::size_t>(count_words(line.substr(1)), 2) - 2;
  }
  return triangles;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = aerate::fuzz::text_of(data, size);
  return aerate::fuzz::read_model(aerate::MeshFormat::obj, text, [&](const aerate::Mesh& mesh) {
    if (text.find_first_of(std::string_view("\\#\0", 3)) == std::string_view::npos)
      aerate::fuzz::require(mesh.triangles.size() == promised_triangles(text),
                            "as many triangles as the faces promise");
  });
}
