// SPDX-License-Identifier: Apache-2.0
// The files by which the Arduino IDE and PlatformIO know the library: that they are of the right form, and
// true.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "tests/support/patterns.hpp"

namespace asip {
namespace {

namespace fs = std::filesystem;

const fs::path kLibrary = ASIP_SOURCE_DIR "/firmware";

std::vector<std::string> lines_of(const fs::path& file) {
    std::ifstream stream(file);
    std::vector<std::string> lines;
    for (std::string line; std::getline(stream, line);)
        lines.push_back(line);
    return lines;
}

std::map<std::string, std::string> properties() {
    std::map<std::string, std::string> all;
    for (const auto& line : lines_of(kLibrary / "library.properties")) {
        const auto equals = line.find('=');
        EXPECT_NE(equals, std::string::npos) << line;
        EXPECT_TRUE(all.emplace(line.substr(0, equals), line.substr(equals + 1)).second) << line;
    }
    return all;
}

nlohmann::json manifest() {
    std::ifstream stream(kLibrary / "library.json");
    return nlohmann::json::parse(stream);
}

std::set<std::string> public_headers() {
    std::set<std::string> headers;
    for (const auto& entry : fs::directory_iterator(kLibrary / "src"))
        if (entry.path().extension() == ".h") headers.insert(entry.path().filename());
    return headers;
}

TEST(LibraryPropertiesTest, RequiredFields_AreThereAndOfTheirForm) {
    const auto all = properties();
    for (const char* name : {"name", "version", "author", "maintainer", "sentence", "paragraph", "category",
                             "url", "architectures"}) {
        ASSERT_TRUE(all.count(name)) << name;
        EXPECT_FALSE(all.at(name).empty()) << name;
    }
    EXPECT_TRUE(test::first_match(all.at("name"), "^[A-Za-z0-9][A-Za-z0-9 _.-]{0,62}$"));
    EXPECT_TRUE(test::first_match(all.at("version"), "^[0-9]+\\.[0-9]+\\.[0-9]+$"));
    const std::set<std::string> categories = {"Display",      "Communication",   "Signal Input/Output",
                                              "Sensors",      "Device Control",  "Timing",
                                              "Data Storage", "Data Processing", "Other"};
    EXPECT_TRUE(categories.count(all.at("category")));
    EXPECT_TRUE(all.at("url").starts_with("https://"));
    EXPECT_TRUE(fs::exists(kLibrary / "src" / all.at("includes")));
}

TEST(LibraryPropertiesTest, Version_IsThatOfTheProjectAndOfPlatformIo) {
    EXPECT_EQ(properties().at("version"), ASIP_VERSION);
    EXPECT_EQ(manifest().at("version"), ASIP_VERSION);
    EXPECT_EQ(manifest().at("name"), properties().at("name"));
}

// An IDE names the folder of the library by it. That of the published library is asip.
TEST(LibraryPropertiesTest, Name_IsAnotherFolderThanThatOfThePublishedLibrary) {
    std::string name = properties().at("name");
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
    EXPECT_NE(name, "asip");
    std::ifstream archive(ASIP_SOURCE_DIR "/packaging/arduino_library");
    const std::string text((std::istreambuf_iterator<char>(archive)), {});
    EXPECT_NE(text.find("FOLDER = \"" + properties().at("name") + "\""), std::string::npos);
}

TEST(LibraryJsonTest, Headers_AreThoseOfTheLibrary) {
    const auto known = manifest();
    std::set<std::string> named;
    for (const auto& header : known.at("headers"))
        named.insert(header.get<std::string>());
    EXPECT_EQ(named, public_headers());
}

TEST(LibraryJsonTest, Examples_AreThoseInTheirFolderWithAllFiles) {
    const auto known = manifest();
    std::set<fs::path> named, there;
    for (const auto& example : known.at("examples"))
        for (const auto& file : example.at("files"))
            named.insert(fs::path(example.at("base").get<std::string>()) / file.get<std::string>());
    for (const auto& entry : fs::recursive_directory_iterator(kLibrary / "examples"))
        if (entry.is_regular_file()) there.insert(fs::relative(entry.path(), kLibrary));
    EXPECT_EQ(named, there);
}

// What an Arduino core itself has.
const std::set<std::string> kCoreHeaders = {"Arduino.h", "Client.h", "ESP8266WiFi.h",
                                            "WiFi.h",    "stdio.h",  "string.h"};

TEST(LibraryExamplesTest, Sketch_IsCalledAsItsFolderAndIncludesTheLibraryAlone) {
    const auto headers = public_headers();
    for (const auto& folder : fs::directory_iterator(kLibrary / "examples")) {
        const auto name = folder.path().filename().string();
        EXPECT_TRUE(fs::exists(folder.path() / (name + ".ino"))) << name;
        for (const auto& file : fs::directory_iterator(folder.path())) {
            for (const auto& line : lines_of(file.path())) {
                if (const auto include = test::first_match(line, "^#include <(.*)>$")) {
                    EXPECT_TRUE(headers.count(include->at(1)) || kCoreHeaders.count(include->at(1)))
                        << file.path() << ": " << line;
                }
                if (const auto include = test::first_match(line, "^#include \"(.*)\"$")) {
                    EXPECT_TRUE(fs::exists(folder.path() / include->at(1))) << file.path() << ": " << line;
                }
            }
        }
    }
}

TEST(KeywordsTest, EachLine_IsAWordATabAndAKind) {
    std::set<std::string> words;
    for (const auto& line : lines_of(kLibrary / "keywords.txt")) {
        const auto parts = test::first_match(line, "^([A-Za-z_][A-Za-z0-9_]*)\t(KEYWORD[123]|LITERAL1)$");
        ASSERT_TRUE(parts) << line;
        EXPECT_TRUE(words.insert(parts->at(1)).second) << line;
    }
    for (const auto& header : public_headers()) {
        if (header.find("Serial") != std::string::npos || header == "Asip.h") continue;
        EXPECT_TRUE(words.count(header.substr(4, header.size() - 6))) << header;
    }
}

}  // namespace
}  // namespace asip
