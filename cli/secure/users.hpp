// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cli/find/target.hpp"
#include "cli/secure/folder.hpp"
#include "cli/secure/report.hpp"

namespace asip::cli {

/// Adds the user and writes its credentials, or keeps both. A credentials file that is there already, of an
/// addition that was interrupted, is used. Fails for a name that is not valid or has another role. `bus` is
/// changed and not yet saved.
Outcome<void> ensure_user(const SecureFolder& folder, SecuredBus& bus, const std::string& name, Role role,
                          SecureReport& report);

/// Those that the labels choose now, as the administrator sees the bus; nothing: there is no selector. Fails
/// where one of the operators commands every board now.
Outcome<SomeBoards> labelled_boards(const SelectorText& selector, const std::vector<std::string>& operators,
                                    const Environment& environment, const SecureFolder& folder,
                                    const SecuredBus& bus);
/// The operator, who must be there, commands these and no others from now on.
void give_boards(SecuredBus& bus, const std::string& name, const std::set<std::string>& boards,
                 const std::string& selector, SecureReport& report);

/// Fails, with the nearest name, when there is no such user.
Outcome<void> check_known(const SecuredBus& bus, const std::string& name);

/// Gives the user a new password and writes its credentials anew.
Outcome<void> renew_user(const SecureFolder& folder, SecuredBus& bus, const std::string& name,
                         SecureReport& report);

/// Takes the user, who must be there, out and removes its credentials from the folder.
Outcome<void> remove_user(const SecureFolder& folder, SecuredBus& bus, const std::string& name,
                          SecureReport& report);

/// Writes the credentials that are here anew, with the same passwords: the broker's addresses have changed.
Outcome<void> refresh_credentials(const SecureFolder& folder, const SecuredBus& bus, SecureReport& report);

/// Saves `bus` and writes what the broker reads of users, in an order in which a run that is killed between
/// is completed by the next one: what the broker reads follows from the saved bus.
Outcome<void> write_users(const SecureFolder& folder, const SecuredBus& bus);

}  // namespace asip::cli
