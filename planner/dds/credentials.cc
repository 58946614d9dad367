#include "planner/dds/credentials.h"

#include <dlfcn.h>
#include <unistd.h>

#include <string>
#include <system_error>

#include "common/input_error.h"

namespace fjr::dds {
namespace {

namespace fs = std::filesystem;

std::string readable(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) throw InputError(file.string(), "", "no such file; DDS Security needs it");
  if (::access(file.c_str(), R_OK) != 0) throw InputError(file.string(), "", "cannot be read; DDS Security needs it");
  return "file:" + fs::absolute(file).string();
}

// Debian keeps the plugins in a folder beside the library where the loader does not look.
std::string plugin(const std::string& name) {
  Dl_info library{};
  const void* inside = reinterpret_cast<const void*>(&dds_create_participant);
  if (::dladdr(inside, &library) != 0 && library.dli_fname != nullptr) {
    const fs::path file = fs::path(library.dli_fname).parent_path() / "libddsc0debian" / ("lib" + name + ".so");
    std::error_code error;
    if (fs::is_regular_file(file, error)) return file.string();
  }
  return name;
}

void add_plugin(Qos& qos, const std::string& part, const std::string& library, const std::string& function) {
  const std::string prefix = "dds.sec." + part + ".library.";
  qos.property(prefix + "path", plugin(library));
  qos.property(prefix + "init", "init_" + function);
  qos.property(prefix + "finalize", "finalize_" + function);
}

}  // namespace

Qos with_credentials(const fs::path& folder) {
  Qos qos;
  qos.property("dds.sec.auth.identity_ca", readable(folder / "identity_ca.cert.pem"));
  qos.property("dds.sec.auth.identity_certificate", readable(folder / "cert.pem"));
  qos.property("dds.sec.auth.private_key", readable(folder / "key.pem"));
  qos.property("dds.sec.access.permissions_ca", readable(folder / "permissions_ca.cert.pem"));
  qos.property("dds.sec.access.governance", readable(folder / "governance.p7s"));
  qos.property("dds.sec.access.permissions", readable(folder / "permissions.p7s"));
  add_plugin(qos, "auth", "dds_security_auth", "authentication");
  add_plugin(qos, "access", "dds_security_ac", "access_control");
  add_plugin(qos, "crypto", "dds_security_crypto", "crypto");
  return qos;
}

}  // namespace fjr::dds
