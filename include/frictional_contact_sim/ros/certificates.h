#pragma once
/**
 * @file certificates.h
 * @brief Verdicts on existence as messages: ~certificate and the service ~certify.
 */
#include <frictional_contact_sim/CertificateReport.h>
#include <frictional_contact_sim/Certify.h>

#include "frictional_contact_sim/simulation/simulator.h"

namespace frictional_contact_sim
{
void fillCertificate(const StepCertificate& certificate, const ros::Time& stamp, CertificateReport& message);

/** @brief Of the problem of the last step. @throws std::invalid_argument when there is none, or for a bad bound */
void certifyStep(const Certify::Request& request, const Simulator& simulator, Certify::Response& response);

}  // namespace frictional_contact_sim
