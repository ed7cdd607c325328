#include "batch/digest.h"

#include <array>
#include <cerrno>
#include <cstddef>
#include <fmt/format.h>
#include <fstream>
#include <memory>
#include <new>
#include <openssl/evp.h>
#include <system_error>
#include <vector>

#include "core/error.h"
#include "files/input_file.h"

namespace aerate::batch {
namespace {

class Sha256 {
 public:
  Sha256() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
    if (!context_ || EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) != 1) throw std::bad_alloc();
  }

  void add(std::string_view bytes) {
    if (EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size()) != 1) throw std::bad_alloc();
  }

  std::string text() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> sum{};
    unsigned size = 0;
    if (EVP_DigestFinal_ex(context_.get(), sum.data(), &size) != 1) throw std::bad_alloc();
    std::string digits;
    for (unsigned i = 0; i < size; ++i) digits += fmt::format("{:02x}", sum[i]);
    return digits;
  }

 private:
  std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> context_;
};

}  // namespace

std::string digest_of(std::string_view bytes) {
  Sha256 sum;
  sum.add(bytes);
  return sum.text();
}

std::string digest_of_file(const std::filesystem::path& path) {
  check_regular_file(path);
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  Sha256 sum;
  std::vector<char> piece(std::size_t{1} << 18);
  while (file.read(piece.data(), static_cast<std::streamsize>(piece.size())) || file.gcount() > 0)
    sum.add({piece.data(), static_cast<std::size_t>(file.gcount())});
  if (!file.eof() || file.bad())
    throw InputError(fmt::format("{}: it cannot be read: {}", path.string(),
                                 std::generic_category().message(errno == 0 ? EIO : errno)));
  return sum.text();
}

}  // namespace aerate::batch
