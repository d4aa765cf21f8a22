#pragma once

#include "resilin/core/projection.hpp"
