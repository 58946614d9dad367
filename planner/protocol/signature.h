// Who published a trajectory: in a domain with DDS Security it is signed with the publisher's identity, so that whoever
// is to run it need not rely on what it came through.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "planner/protocol/execution_messages.h"

struct evp_pkey_st;
struct x509_store_st;

namespace fjr {

inline constexpr std::string_view kPublisherRole = "service";  // OU of the certificate; config/security/roles.txt
inline constexpr std::size_t kLongestSignature = 512, kLongestCertificate = 8192;  // [bytes] of idl/fjr_msgs.idl

// All that a trajectory says, in the order of fjr::msg::Trajectory2 and without padding: "fjr/trajectory_2", or where
// its rows were learnt "fjr/learnt_trajectory", then every member up to `stops`. Numbers are little-endian, booleans
// one byte; strings and sequences are preceded by their length, 32 bits.
std::string signed_bytes(const TrajectoryOrder& order);

class Signer {
 public:
  // Reads cert.pem and key.pem of the credentials in `folder` (dds/credentials.h), and tries them: what it signs passes
  // the SignatureCheck of this folder and fits into a message. Throws InputError naming the file.
  explicit Signer(const std::filesystem::path& folder, std::string_view role = kPublisherRole);

  // With SHA-256, by the key's algorithm (ECDSA for those of make_credentials.sh). Throws std::runtime_error.
  Signature sign(std::string_view message) const;

 private:
  std::shared_ptr<evp_pkey_st> key_;
  std::string certificate_;  // DER
};

class SignatureCheck {
 public:
  // Reads identity_ca.cert.pem of the credentials in `folder`. Throws InputError.
  explicit SignatureCheck(const std::filesystem::path& folder);

  // Empty, or one sentence: it is not signed, its signer is unknown to the identity authority or has another role, or
  // the signature is not that of this message.
  std::string fault_of(std::string_view message, const Signature& signature, std::string_view role) const;

 private:
  std::shared_ptr<x509_store_st> authority_;
};

}  // namespace fjr
