#error "the hardware target has neither Bullet nor EGL nor epoxy"
