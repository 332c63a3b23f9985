// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "asip/expected.hpp"
#include "asip/links/rules.hpp"

namespace asip::agent {

struct KeptLink {
    links::Link link;
    links::Kept kept{};
};
std::string to_text(const KeptLink& link);

/// Links of boards on the disk: FOLDER/links/BOARD/NAME.json, one file for each.
class LinkFiles {
  public:
    explicit LinkFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}

    struct Loaded {
        std::vector<KeptLink> links;
        struct Fault {
            std::string name;  ///< of the file as it is now, for everybody
            std::string why;   ///< with its path, for the log
        };
        std::vector<Fault> faults;  ///< of files that cannot be read
    };
    /// A file that cannot be read is put aside, as NAME.json.damaged; the others count.
    Loaded load(const std::string& board) const;
    /// An empty text removes the file. Returns when that is on the disk.
    Expected<void> save(const std::string& board, const std::string& name, const std::string& text) const;

  private:
    std::filesystem::path folder_;
};

}  // namespace asip::agent
