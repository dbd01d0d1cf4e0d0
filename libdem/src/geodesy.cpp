#include "dem/geodesy.h"
