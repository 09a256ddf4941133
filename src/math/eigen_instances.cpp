// Here the instances are defined, elsewhere they are declared extern.
#define EIGEN_INSTANCE template
#include "eigen_instances.h"
