// SPDX-License-Identifier: Apache-2.0
#include "cli/backup/sealed.hpp"

#include <fcntl.h>
#include <openssl/evp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>

#include "cli/secure/secrets.hpp"

namespace asip::cli {
namespace {

constexpr std::string_view kSealed = "asip-backup 1 sealed\n";
constexpr std::string_view kPublic = "asip-backup 1 public\n";
constexpr std::string_view kAnyVersion = "asip-backup ";
constexpr std::size_t kBackupSaltBytes = 16, kTagBytes = 16, kKeyBytes = 32, kNonceBytes = 12;
constexpr std::size_t kFrontBytes = kSealed.size() + kBackupSaltBytes;
constexpr std::size_t kPartBytes = std::size_t{64} << 10;
constexpr std::uint64_t kScryptCost = 1 << 16, kScryptBlock = 8, kScryptMemory = 128 << 20;

const unsigned char* bytes_of(std::string_view text) {
    return reinterpret_cast<const unsigned char*>(text.data());
}

/// AES-256-GCM in one direction, over the front and all that follows.
class Cipher {
  public:
    Cipher(const Passphrase& passphrase, std::string_view front, bool encrypts)
        : context_(EVP_CIPHER_CTX_new(), EVP_CIPHER_CTX_free) {
        std::array<unsigned char, kKeyBytes + kNonceBytes> key{};
        const auto salt = front.substr(kSealed.size());
        int count = 0;
        // A salt serves one file, and its key one nonce.
        valid_ = EVP_PBE_scrypt(passphrase.text.data(), passphrase.text.size(), bytes_of(salt), salt.size(),
                                kScryptCost, kScryptBlock, 1, kScryptMemory, key.data(), key.size()) == 1 &&
                 EVP_CipherInit_ex(context_.get(), EVP_aes_256_gcm(), nullptr, key.data(),
                                   key.data() + kKeyBytes, encrypts ? 1 : 0) == 1 &&
                 EVP_CipherUpdate(context_.get(), nullptr, &count, bytes_of(front),
                                  static_cast<int>(front.size())) == 1;
    }
    bool valid() const { return valid_; }
    bool pass(std::string_view from, std::string& to) {
        to.resize(from.size());
        int count = 0;
        return EVP_CipherUpdate(context_.get(), reinterpret_cast<unsigned char*>(to.data()), &count,
                                bytes_of(from), static_cast<int>(from.size())) == 1 &&
               static_cast<std::size_t>(count) == from.size();
    }
    std::string tag() {
        std::string tag(kTagBytes, '\0');
        const bool done =
            end() && EVP_CIPHER_CTX_ctrl(context_.get(), EVP_CTRL_GCM_GET_TAG, kTagBytes, tag.data()) == 1;
        return done ? tag : std::string();
    }
    bool proves(std::string tag) {
        return EVP_CIPHER_CTX_ctrl(context_.get(), EVP_CTRL_GCM_SET_TAG, kTagBytes, tag.data()) == 1 && end();
    }

  private:
    bool end() {
        std::array<unsigned char, kTagBytes> none{};
        int count = 0;
        return EVP_CipherFinal_ex(context_.get(), none.data(), &count) == 1;
    }

    std::unique_ptr<EVP_CIPHER_CTX, decltype(&EVP_CIPHER_CTX_free)> context_;
    bool valid_ = false;
};

tl::unexpected<Failure> failed_with(const std::string& what) {
    return failure(program::kExitFailure, what + ": " + std::strerror(errno));
}

}  // namespace

Outcome<void> seal(const Descriptor& out, const Passphrase& passphrase,
                   const std::function<Outcome<void>(const Sink& sink)>& produce) {
    const auto front = std::string(passphrase.given ? kSealed : kPublic) + random_bytes(kBackupSaltBytes);
    Cipher cipher(passphrase, front, true);
    if (!cipher.valid()) return failure(program::kExitFailure, "no key can be made (memory is short)");
    std::uint64_t written = 0;
    bool good = out.write(front);
    std::string chunk;
    const auto produced = produce([&](std::string_view bytes) {
        for (; good && !bytes.empty(); bytes.remove_prefix(chunk.size())) {
            good = cipher.pass(bytes.substr(0, kPartBytes), chunk) && out.write(chunk);
            written += chunk.size();
        }
        return good;
    });
    if (!good) return failed_with("the backup cannot be written");
    if (!produced) return produced;
    if (written > kMaxBackupBytes - (std::uint64_t{1} << 20))
        return failure(program::kExitFailure, "the backup is above 32 GiB");
    const auto tag = cipher.tag();
    if (tag.empty() || !out.write(tag) || !out.sync()) return failed_with("the backup cannot be written");
    return {};
}

Descriptor nameless_file() {
    std::string name = "/var/tmp/asip-XXXXXX";
    Descriptor file(::mkostemp(name.data(), O_CLOEXEC));  // 0600
    if (file.valid()) ::unlink(name.c_str());
    return file;
}

bool each_part(const Descriptor& file, std::uint64_t at, std::uint64_t bytes, const Sink& use) {
    std::string part;
    for (ssize_t count = 0; bytes > 0;
         at += static_cast<std::uint64_t>(count), bytes -= static_cast<std::uint64_t>(count)) {
        part.resize(static_cast<std::size_t>(std::min<std::uint64_t>(kPartBytes, bytes)));
        count = ::pread(file.number(), part.data(), part.size(), static_cast<off_t>(at));
        if (count <= 0 || !use(std::string_view(part).substr(0, static_cast<std::size_t>(count))))
            return false;
    }
    return true;
}

Outcome<bool> unseal(const std::string& file, const std::function<Outcome<Passphrase>()>& ask,
                     const Descriptor& out) {
    const Descriptor in(::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
    struct stat status{};
    if (!in.valid() || ::fstat(in.number(), &status) != 0) return failed_with(file);
    const auto size = static_cast<std::uint64_t>(status.st_size);
    std::string front, tag, chunk;
    const auto into = [](std::string& text) {
        return [&text](std::string_view part) { return text += part, true; };
    };
    const bool whole = S_ISREG(status.st_mode) && size <= kMaxBackupBytes &&
                       each_part(in, 0, kFrontBytes, into(front)) && size >= kFrontBytes + kTagBytes &&
                       each_part(in, size - kTagBytes, kTagBytes, into(tag));
    const bool sealed = front.starts_with(kSealed);
    if (front.starts_with(kAnyVersion) && !sealed && !front.starts_with(kPublic))
        return failure(program::kExitFailure, file + " was made by another version of asipctl");
    if (!whole || !front.starts_with(kAnyVersion))
        return failure(program::kExitFailure, file + " is no backup that asipctl made, or not whole");
    const auto passphrase = sealed ? ask() : Passphrase();
    if (!passphrase) return tl::unexpected(passphrase.error());
    Cipher cipher(*passphrase, front, false);
    if (!cipher.valid()) return failure(program::kExitFailure, "no key can be made (memory is short)");
    errno = 0;
    if (!each_part(in, kFrontBytes, size - kTagBytes - kFrontBytes,
                   [&](std::string_view part) { return cipher.pass(part, chunk) && out.write(chunk); }))
        return failed_with("no room to read " + file);
    if (!cipher.proves(tag))
        return failure(program::kExitFailure, (sealed ? "another passphrase, or " + file : file) +
                                                  " is damaged; nothing was restored");
    return sealed;
}

}  // namespace asip::cli
