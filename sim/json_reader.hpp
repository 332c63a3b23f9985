#pragma once
#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>
#include <vector>

namespace asip::sim {

/// Reads the members of one JSON object and notes the first thing that is wrong, with its place
/// ("parts[2].pin: ..."). After a fault every read gives its default, so that callers need no branches.
class JsonReader {
  public:
    /// `place` is empty for the document itself. The readers of one document share `first_fault`. The object
    /// and the fault outlive the reader.
    JsonReader(const nlohmann::json& object, std::string place, std::string& first_fault);

    const nlohmann::json& value() const { return *object_; }
    bool has(const std::string& key);
    /// Null (and a fault) if it is missing.
    const nlohmann::json* required(const std::string& key);
    std::string text(const std::string& key, const std::string& otherwise);
    double number(const std::string& key, double otherwise, double minimum, double maximum);
    bool flag(const std::string& key);
    std::vector<JsonReader> list(const std::string& key);

    /// A fault for each member that was not asked for.
    void refuse_others();
    /// Notes a fault of a member (of the whole object where `key` is empty).
    void fault(const std::string& key, const std::string& reason);
    /// Notes a fault whose text has its place.
    void fault_at(std::string fault);
    bool faulty() const { return !first_fault_->empty(); }

  private:
    const nlohmann::json* find(const std::string& key);

    const nlohmann::json* object_;
    std::string place_;
    std::string* first_fault_;
    std::set<std::string> known_;
};

}  // namespace asip::sim
