// SPDX-License-Identifier: Apache-2.0
#include "asip/model/model_set.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

namespace asip::model {
namespace model_set_test {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr auto kFan = R"({"name":"fan","version":1,"id":"F","match":["Fan"],"title":"A fan"})";

class ModelSetTest : public testing::Test {
  protected:
    ModelSetTest() {
        auto pattern = (fs::temp_directory_path() / "asip-models-XXXXXX").string();
        folder_ = mkdtemp(pattern.data());
    }
    ~ModelSetTest() override { fs::remove_all(folder_); }

    void write(const std::string& name, std::string_view text) { std::ofstream(folder_ / name) << text; }

    fs::path folder_;
    ModelSet models_ = ModelSet::standard();
};

TEST_F(ModelSetTest, Standard_HasEveryServiceOfTheProtocol) {
    EXPECT_THAT(models_.names(),
                testing::ElementsAre("acceleration", "bump", "climate", "distance", "encoders", "gyroscope",
                                     "heading", "humidity", "hygrometer", "i2c", "illuminance", "io", "lcd",
                                     "motors", "neopixels", "onewire", "pixels", "pressure", "reflectance",
                                     "servo", "spi", "steppers", "thermometers", "tone", "weather"));
    EXPECT_TRUE(models_.find_ref("distance@1"));
    EXPECT_FALSE(models_.find_ref("distance@2"));
    EXPECT_FALSE(models_.find_ref("distance"));
    EXPECT_FALSE(models_.find("nothing"));
}

TEST_F(ModelSetTest, Folder_AddsItsModels) {
    write("fan.json", kFan);
    write("schema.json", "not a model");
    write("README", "no model either");
    ASSERT_TRUE(models_.load_directory(folder_));
    EXPECT_EQ(models_.match('F', "Big fan")->name, "fan");
    EXPECT_EQ(models_.all().size(), ModelSet::standard().all().size() + 1);
    EXPECT_FALSE(ModelSet::is_standard(*models_.find("fan")));
}

TEST_F(ModelSetTest, ModelOfAStandardName_ReplacesItAndIsNoLongerStandard) {
    write("d.json", R"({"name":"distance","version":1,"id":"D","title":"Mine"})");
    ASSERT_TRUE(models_.load_directory(folder_));
    EXPECT_EQ(models_.find("distance")->title, "Mine");
    EXPECT_FALSE(ModelSet::is_standard(*models_.find("distance")));
    EXPECT_TRUE(ModelSet::is_standard(*models_.find("servo")));
    EXPECT_EQ(models_.all().size(), ModelSet::standard().all().size());
}

TEST_F(ModelSetTest, OneBrokenFile_ChangesNothingAndNamesFilePlaceAndReason) {
    write("a.json", kFan);
    write("b.json", R"({"name":"bad","version":1,"id":"B"})");
    const auto result = models_.load_directory(folder_);
    ASSERT_FALSE(result);
    EXPECT_THAT(result.error(), HasSubstr("b.json: /: has no member \"title\""));
    EXPECT_FALSE(models_.find("fan"));
}

TEST_F(ModelSetTest, MissingFolderOrHugeFile_IsRefused) {
    EXPECT_FALSE(models_.load_directory((folder_ / "none").string()));
    write("huge.json", std::string(70000, ' '));
    EXPECT_FALSE(models_.load_directory(folder_));
}

}  // namespace model_set_test
}  // namespace asip::model
