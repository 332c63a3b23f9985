// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "asip/descriptor.hpp"
#include "cli/environment.hpp"

/// The outside of a backup: a line that says its version, a salt, and one text under AES-256-GCM with a key
/// of the passphrase (scrypt), which proves the line, too. Nothing inside is looked at before the proof is
/// right.
namespace asip::cli {

/// Without a passphrase it is public: the proof finds damage, and anybody can make it.
struct Passphrase {
    std::string text{};  ///< any bytes
    bool given = false;
};

inline constexpr std::uint64_t kMaxBackupBytes = std::uint64_t{32} << 30;  // below what one key may carry

/// Writes what `produce` gives to its argument, which is false once that failed.
using Sink = std::function<bool(std::string_view bytes)>;
Outcome<void> seal(const Descriptor& out, const Passphrase& passphrase,
                   const std::function<Outcome<void>(const Sink& sink)>& produce);

/// On a disk, and gone when it is closed. Where there is no room: none.
Descriptor nameless_file();
/// Gives so many bytes of a file from there to `use`, in parts. False: there are fewer, or `use` failed.
bool each_part(const Descriptor& file, std::uint64_t at, std::uint64_t bytes, const Sink& use);
/// Copies the text of the file to `out`, which is of use only if this does not fail. True: it was sealed with
/// the passphrase, for which `ask` is called.
Outcome<bool> unseal(const std::string& file, const std::function<Outcome<Passphrase>()>& ask,
                     const Descriptor& out);

/// The bytes before the first line end of the file ("-": standard input); without a file it is typed, twice
/// for a new one. 8 to 1,024 bytes.
Outcome<Passphrase> read_passphrase(const std::string& file, bool made_now, const Environment& environment);

}  // namespace asip::cli
