"""Analyses of the product: model choice by accuracy, uncertainty, biaxial tests."""
